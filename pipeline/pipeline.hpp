// The journey of a frame: localise (each frame, tracking thread), then what is done beside it.
// No threads, files or clocks of its own: the daemon and `povslam replay` run the same object.
//
//   Pipeline pipeline(options, calibration, T_world_body_start);
//   for each frame:  publish(pipeline.localise(frame));
//                    while (const auto job = pipeline.take_job()) …solve(*job, …) beside tracking…
//                    …once solved, before a later localise(): pipeline.give_back(*job);
// Answers enter backend.delay_frames and window.delay_frames after they were asked for, or later if they come later.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "pipeline/backend_job.hpp"
#include "pipeline/frames/calibration.hpp"
#include "pipeline/frames/rgbd_frame.hpp"
#include "pipeline/frontend/map_rows.hpp"
#include "pipeline/objects/view.hpp"
#include "pipeline/options.hpp"
#include "pipeline/output.hpp"
#include "pipeline/understanding.hpp"
#include "pipeline/vem_exchange.hpp"

namespace povslam {

class Pipeline {
 public:
  // T_world_body_start: where the body is at the first frame (world is level there; a dock pose or the origin).
  // map: what an earlier session learned; null: nothing yet.
  Pipeline(const PipelineOptions& options, const SensorCalibration& calibration, const Rigid3& T_world_body_start,
           const MapContent* map = nullptr);
  ~Pipeline();

  // Tracks one frame. After warm-up neither allocates nor locks. The result is valid until the next call.
  const PoseEstimate& localise(const RgbdFrame& frame);

  // After localise(): work to be done beside tracking with solve(), or none; call until there is none. It stays the
  // pipeline's; the caller may hand it to another thread and must give it back, solved or not, between two calls of
  // localise().
  std::optional<BackendJob> take_job();
  void give_back(const BackendJob& job);

  // After localise(): what became of the map since the last change taken, or null when nothing did, or too little time
  // has passed (map.change_period_s of frame stamps). One is out at a time; give it back between two calls once it is
  // stored. collect_change(): whatever is left, for the end of a session; null: nothing.
  MapChange* take_change();
  MapChange* collect_change();
  void give_back(MapChange* change);

  // After localise(): whether the frame should be understood (Understanding): it has a pose, and
  // understanding.period_s have passed since the last view filled. fill_view() reuses the view's buffers.
  bool view_due() const;
  void fill_view(const RgbdFrame& frame, View& view);
  // Which objects landmarks belong to, and what is believed of objects, as Understood said. Between two calls of
  // localise(). What a view told enters understanding.answer_delay_s after it was taken.
  void take_owners(std::span<const LandmarkOwner> owners);
  void take_beliefs(std::span<const ObjectBelief> beliefs);
  void take_restored(const Understanding& understanding);  // both, of an earlier session, before the first frame

  // Present pose of a keyframe named by a PoseEstimate (also of one merged away since), T_world_camera.
  std::optional<Rigid3> keyframe_pose(std::int64_t keyframe) const;
  MapSize map_size() const;
  LoopCounts loops() const;  // since the start
  VemCounts vem() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace povslam
