// Runs the pipeline over a source of frames and keeps what came out: in one thread, or as the daemon does it.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config_file.hpp"
#include "drivers/driver.hpp"
#include "drivers/replay/trajectory_file.hpp"
#include "pipeline/output.hpp"
#include "pipeline/understanding.hpp"
#include "pipeline/vem_counts.hpp"

namespace povslam {

struct ReplaySettings {
  AppConfig config;                            // sensors[0] says the mount; the frames come from the driver given
  std::optional<Rigid3> T_world_camera_start;  // else config.start
  std::filesystem::path map;                   // store to begin with and to go on writing to; empty: none
  std::vector<StampedPose> true_poses;         // T_world_camera in place of the tracked ones; empty: those
};

enum class Stage : std::uint8_t {
  features,
  track,
  keyframe,
  smooth,
  close_loop,
  vem,
  segment,
  name,
  associate,
  integrate,
  total
};
inline constexpr std::array<const char*, 11> kStageNames = {"features",   "track",     "keyframe", "smooth",
                                                            "close_loop", "vem",       "segment",  "name",
                                                            "associate",  "integrate", "total"};

struct MapAt {
  TimeNs stamp = 0;
  MapSize size;
};

struct ReplayRecord {
  std::size_t frames = 0, tracked = 0, lost = 0;
  std::vector<StampedPose> published;                            // as published when the frame was tracked
  std::vector<StampedPose> smoothed;                             // the same frames after all later corrections
  std::array<std::vector<float>, kStageNames.size()> stages_ms;  // by Stage; CPU of the working thread
  std::vector<MapAt> map;                                        // after each frame, as many as stages_ms has
  std::array<std::int64_t, 6> drops{};                           // by DropReason
  double wall_s = 0.0, cpu_s = 0.0, tracking_cpu_s = 0.0, feeder_cpu_s = 0.0;
  LoopCounts loops;
  VemCounts vem;
  std::vector<ObjectEvent> events;
  std::vector<ObjectRecord> objects;  // at the end
  LabelCounts labels;
  NamingCounts naming;
  std::int64_t labels_dropped = 0;                       // on their way, in real time
  std::int64_t views_understood = 0, views_dropped = 0;  // dropped: in real time
  Mesh mesh;                                             // of what stands at the end
  std::string failure;                                   // why it ended early; empty: it did not
};

// One thread; no frame is dropped and nothing depends on time. Stops early on SIGINT or SIGTERM.
Result<ReplayRecord> replay_in_one_thread(const ReplaySettings& settings, Driver& driver);

// The daemon's own App, fed by a driver that paces itself; frames that come too fast are dropped and counted.
Result<ReplayRecord> replay_in_real_time(const ReplaySettings& settings, std::unique_ptr<Driver> driver);

}  // namespace povslam
