// A real recording twice through one map, then frames of the second pass shown to that map without any prior:
// real_map_bench --sequence FOLDER --camera NAME (see --help). Errors against the recording's reference poses, after
// the alignment that fits the poses of both passes best, since the map's world is not the reference's; and against the
// poses that tracking itself gave, which tells the search's own part.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "daemon/config_file.hpp"
#include "drivers/registry.hpp"
#include "drivers/replay/trajectory_file.hpp"
#include "pipeline/geometry/align.hpp"
#include "tools/bench/journey.hpp"
#include "tools/povslam/progress.hpp"

namespace povslam {
namespace {

struct Arguments {
  std::string sequence, camera, out;
  std::vector<std::string> settings;
  int every = 20;   // frames
  int frames = 30;  // a second of the recording
};

struct Recording {
  SensorCalibration calibration;
  std::vector<RgbdFrame> frames;
  std::vector<std::optional<Rigid3>> T_reference_camera;
};

Result<Recording> read_recording(const Arguments& arguments) {
  const auto truth = read_trajectory(arguments.sequence + "/groundtruth.txt");
  if (!truth) return truth.error();
  DriverOptions options{{"path", arguments.sequence}, {"realtime", "false"}};
  if (!arguments.camera.empty()) options["camera"] = arguments.camera;
  auto driver = make_driver("replay", options);
  if (!driver) return driver.error();
  Result<DriverSetup> setup = (*driver)->open();
  if (!setup) return setup.error();
  Recording recording{setup->sensors[0], {}, {}};
  recording.calibration.T_body_sensor = level_forward_camera();
  SensorFrame frame;
  while (true) {
    const Next next = (*driver)->next(frame);
    if (next.kind == Next::Kind::failed) return Error{next.message};
    if (next.kind == Next::Kind::end) break;
    if (next.kind != Next::Kind::frame || frame.kind != SensorKind::rgbd) continue;
    recording.T_reference_camera.push_back(pose_at(*truth, frame.rgbd.stamp, 0.1));
    recording.frames.push_back(std::move(frame.rgbd));
    frame.rgbd = {};
  }
  if (recording.frames.empty()) return Error{arguments.sequence + " has no frames"};
  return recording;
}

class RealMapBench {
 public:
  RealMapBench(const Arguments& arguments, const PipelineOptions& options, Recording recording)
      : arguments_(arguments), options_(options), recording_(std::move(recording)) {}

  void make_map() {
    Journey journey(options_, recording_.calibration, Rigid3{});
    for (int pass = 0; pass < 2; ++pass) {
      poses_.assign(recording_.frames.size(), std::nullopt);
      int lost = 0;
      for (std::size_t i = 0; i < recording_.frames.size(); ++i) {
        const PoseEstimate& pose = journey.track(stamped(i, pass));
        lost += !has_pose(pose);
        if (!has_pose(pose) || pose.num_landmarks == 0) continue;  // none, or only held
        poses_[i] = pose.T_world_camera;
        if (recording_.T_reference_camera[i]) pairs_.push_back({*recording_.T_reference_camera[i], *poses_[i]});
      }
      const MapSize size = journey.pipeline().map_size();
      std::printf("pass %d: %zu frames, %d lost; map of %d keyframes, %d landmarks; loops closed %d, joined %d\n",
                  pass + 1, recording_.frames.size(), lost, size.keyframes, size.landmarks,
                  journey.pipeline().loops().closed, journey.pipeline().loops().joined);
    }
    map_ = journey.content();
    align();
  }

  void ask() {
    options_.frontend.map.mode = "localise";
    Progress progress("asked", recording_.frames.size() / static_cast<std::size_t>(arguments_.every));
    for (std::size_t i = 0; i < recording_.frames.size(); i += static_cast<std::size_t>(arguments_.every)) {
      asked_.push_back(ask_from(i));
      progress.step();
    }
  }

  void print() const {
    std::vector<double> frames, m, deg, tracked_m, tracked_deg, between_m, between_deg;
    int wrong = 0, wrong_later = 0, tracked_wrong = 0;
    for (const Asked& asked : asked_) {
      wrong_later += asked.wrong > 0;
      if (!asked.found) continue;
      frames.push_back(asked.frames);
      wrong += asked.reference.wrong();
      m.push_back(asked.reference.m);
      deg.push_back(asked.reference.deg);
      if (!asked.tracked) continue;
      tracked_wrong += asked.tracked_reference.wrong();
      tracked_m.push_back(asked.tracked_reference.m);
      tracked_deg.push_back(asked.tracked_reference.deg);
      between_m.push_back(asked.between.m);
      between_deg.push_back(asked.between.deg);
    }
    std::printf(
        "each %d-th frame on, without a prior: %zu asked, %zu found within %d frames (%.1f %%), after %.0f (median), "
        "%.0f (most)\n",
        arguments_.every, asked_.size(), frames.size(), arguments_.frames,
        100.0 * static_cast<double>(frames.size()) / static_cast<double>(std::max<std::size_t>(1, asked_.size())),
        quantile(frames, 0.5), quantile(frames, 1.0));
    print_errors("first pose against the reference", m, deg);
    print_errors("tracking there, likewise", tracked_m, tracked_deg);
    print_errors("first pose against tracking", between_m, between_deg);
    std::printf(
        "  more than 0.3 m or 5 degrees off the reference: first pose %d, any pose of the second after it %d, tracking "
        "%d\n",
        wrong, wrong_later, tracked_wrong);
  }

  nlohmann::ordered_json json() const {
    nlohmann::ordered_json asked = nlohmann::json::array();
    for (const Asked& one : asked_) {
      asked.push_back({{"frame", one.frame},
                       {"found", one.found},
                       {"frames", one.frames},
                       {"m", one.reference.m},
                       {"deg", one.reference.deg},
                       {"between_m", one.between.m},
                       {"wrong", one.wrong}});
    }
    return {{"sequence", arguments_.sequence}, {"asked", asked}};
  }

 private:
  struct Pair {
    Rigid3 T_reference_camera, T_world_camera;
  };
  struct Asked {
    std::size_t frame = 0;
    bool found = false, tracked = false;              // tracked: the second pass had a pose there
    int frames = 0, wrong = 0;                        // until found; published and off the reference
    PoseError reference, tracked_reference, between;  // of the first pose; of tracking; one against the other
  };

  static void print_errors(const char* what, const std::vector<double>& m, const std::vector<double>& deg) {
    std::printf("  %-34s median %.4f m, %5.2f deg; most %.4f m, %5.2f deg\n", what, quantile(m, 0.5),
                quantile(deg, 0.5), quantile(m, 1.0), quantile(deg, 1.0));
  }

  // The second pass comes a minute after the first.
  const RgbdFrame& stamped(std::size_t i, int pass) {
    constexpr TimeNs kPause = from_seconds(60.0);
    const TimeNs whole = recording_.frames.back().stamp - recording_.frames.front().stamp + kPause;
    shown_ = recording_.frames[i];
    shown_.stamp += pass * whole;
    shown_.depth_stamp += pass * whole;
    return shown_;
  }

  void align() {
    std::vector<Eigen::Vector3d> reference, world;
    for (const Pair& pair : pairs_) {
      reference.push_back(pair.T_reference_camera.translation);
      world.push_back(pair.T_world_camera.translation);
    }
    if (const auto best = align_points(reference, world)) T_reference_world_ = *best;
    double square = 0.0;
    std::vector<double> deg;
    for (const Pair& pair : pairs_) {
      const PoseError error = error_of(T_reference_world_ * pair.T_world_camera, pair.T_reference_camera);
      square += error.m * error.m;
      deg.push_back(error.deg);
    }
    std::printf("tracking, both passes aligned: ATE %.4f m, rotation %.2f deg (median)\n",
                std::sqrt(square / static_cast<double>(std::max<std::size_t>(1, pairs_.size()))), quantile(deg, 0.5));
  }

  Asked ask_from(std::size_t first) {
    Asked asked;
    asked.frame = first;
    Journey journey(options_, recording_.calibration, Rigid3{}, &map_);
    const std::size_t end = std::min(recording_.frames.size(), first + static_cast<std::size_t>(arguments_.frames));
    for (std::size_t i = first; i < end; ++i) {
      const PoseEstimate& pose = journey.track(recording_.frames[i]);
      if (!has_pose(pose)) continue;
      const std::optional<Rigid3>& T_reference_camera = recording_.T_reference_camera[i];
      PoseError reference;
      if (T_reference_camera) reference = error_of(T_reference_world_ * pose.T_world_camera, *T_reference_camera);
      asked.wrong += reference.wrong();
      if (asked.found) continue;
      asked.found = true;
      asked.frames = static_cast<int>(i - first) + 1;
      asked.reference = reference;
      if (!poses_[i] || !T_reference_camera) continue;
      asked.tracked = true;
      asked.tracked_reference = error_of(T_reference_world_ * *poses_[i], *T_reference_camera);
      asked.between = error_of(pose.T_world_camera, *poses_[i]);
    }
    return asked;
  }

  Arguments arguments_;
  PipelineOptions options_;
  Recording recording_;
  RgbdFrame shown_;
  std::vector<std::optional<Rigid3>> poses_;  // by frame, as tracked in the second pass
  std::vector<Pair> pairs_;
  MapContent map_;
  Rigid3 T_reference_world_;
  std::vector<Asked> asked_;
};

Status measure(const Arguments& arguments) {
  const Result<AppConfig> config = load_config("", arguments.settings);
  if (!config) return config.error();
  Result<Recording> recording = read_recording(arguments);
  if (!recording) return recording.error();
  RealMapBench bench(arguments, config->pipeline, std::move(*recording));
  bench.make_map();
  bench.ask();
  bench.print();
  if (arguments.out.empty()) return Done{};
  std::ofstream file(arguments.out);
  file << bench.json().dump(1) << '\n';
  file.close();
  if (!file) return Error{arguments.out + ": cannot be written"};
  return Done{};
}

}  // namespace
}  // namespace povslam

int main(int argc, char** argv) {
  povslam::Arguments arguments;
  CLI::App cli{"A real recording twice through one map, then frames found in it without a prior.", "real_map_bench"};
  cli.add_option("--sequence", arguments.sequence, "Recorded sequence with groundtruth.txt")->required();
  cli.add_option("--camera", arguments.camera, "Camera preset, for a sequence without camera.yaml");
  cli.add_option("--every", arguments.every, "Ask from each so many-th frame on")
      ->capture_default_str()
      ->check(CLI::Range(1, 100'000));
  cli.add_option("--frames", arguments.frames, "Within which it should be found")
      ->capture_default_str()
      ->check(CLI::Range(1, 100'000));
  cli.add_option("--set", arguments.settings, "key=value of the configuration")->allow_extra_args(false);
  cli.add_option("--out", arguments.out, "Write the figures to this file as JSON");
  CLI11_PARSE(cli, argc, argv);
  const povslam::Status done = povslam::measure(arguments);
  if (done) return 0;
  std::fprintf(stderr, "real_map_bench: %s\n", done.error().message.c_str());
  return 1;
}
