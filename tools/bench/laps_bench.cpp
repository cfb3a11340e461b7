// The same route lap after lap in a simulated world where nothing changes: laps_bench --scene NAME (see --help). Per
// lap: error of the poses as published (only the first pose of all fixed), loops, size of the map, CPU of a frame.
// Frames are rendered as they are needed; nothing is written to disk.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "daemon/config_file.hpp"
#include "drivers/synthetic/renderer.hpp"
#include "drivers/synthetic/synthetic_driver.hpp"
#include "pipeline/geometry/align.hpp"
#include "tools/bench/journey.hpp"
#include "tools/povslam/progress.hpp"

namespace povslam {
namespace {

struct Lap {
  int frames = 0, lost = 0;
  double square = 0.0, worst_m = 0.0, end_m = 0.0, worst_step_m = 0.0;
  std::vector<float> ms;
  std::vector<Eigen::Vector3d> truth, estimate;  // of frames with a pose
  MapSize map;
  LoopCounts loops;
  std::uint32_t map_version = 0;

  double ate_m() const { return std::sqrt(square / std::max(1, frames - lost)); }
  // After the best alignment of this lap alone: its shape. A wrong heading of the first pose turns the whole lap.
  double aligned_m() const {
    const std::optional<Rigid3> T_truth_estimate = align_points(truth, estimate);
    if (!T_truth_estimate) return 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) sum += (truth[i] - *T_truth_estimate * estimate[i]).squaredNorm();
    return std::sqrt(sum / static_cast<double>(truth.size()));
  }
};

class LapsBench {
 public:
  LapsBench(const PipelineOptions& options, const synthetic::World& world)
      : world_(world),
        renderer_(world),
        journey_(options, synthetic::sensor_calibrations(world.options()).front(), world.T_world_body(0.0)) {}

  void drive() {
    Progress progress("laps", world_.num_frames());
    for (std::uint64_t i = 0; i < world_.num_frames(); ++i) {
      const double t = to_seconds(world_.frame_time(i));
      while (t > world_.lap_end_s(static_cast<double>(laps_.size())) + 1e-3) laps_.emplace_back();
      if (laps_.empty()) laps_.emplace_back();
      renderer_.render_at(t, frame_);
      frame_.stamp = frame_.depth_stamp = world_.start_stamp() + world_.frame_time(i);
      add(journey_.track(frame_), world_.T_world_camera(t));
      progress.step();
    }
  }

  void print() const {
    std::printf("%-8s %4s %4s %6s %5s %8s %8s %8s %8s %8s %6s %6s %7s %8s %9s %9s %7s %7s\n", "scene", "seed", "lap",
                "frames", "lost", "ATE[m]", "aligned", "max[m]", "end[m]", "jump[m]", "closed", "joined", "refused",
                "version", "keyframes", "landmarks", "ms p50", "p99");
    for (std::size_t i = 0; i < laps_.size(); ++i) {
      const Lap& lap = laps_[i];
      std::printf("%-8s %4llu %4zu %6d %5d %8.4f %8.4f %8.4f %8.4f %8.4f %6d %6d %7d %8u %9d %9d %7.2f %7.2f\n",
                  world_.options().scene.c_str(), static_cast<unsigned long long>(world_.options().seed), i + 1,
                  lap.frames, lap.lost, lap.ate_m(), lap.aligned_m(), lap.worst_m, lap.end_m, lap.worst_step_m,
                  lap.loops.closed, lap.loops.joined, lap.loops.refused, lap.map_version, lap.map.keyframes,
                  lap.map.landmarks, static_cast<double>(quantile(lap.ms, 0.5)),
                  static_cast<double>(quantile(lap.ms, 0.99)));
    }
  }

  nlohmann::ordered_json json() const {
    nlohmann::ordered_json laps = nlohmann::json::array();
    Lap all;
    for (const Lap& lap : laps_) {
      all.frames += lap.frames;
      all.lost += lap.lost;
      all.square += lap.square;
      laps.push_back({{"frames", lap.frames},
                      {"lost", lap.lost},
                      {"ate_m", lap.ate_m()},
                      {"aligned_ate_m", lap.aligned_m()},
                      {"worst_m", lap.worst_m},
                      {"end_m", lap.end_m},
                      {"jump_m", lap.worst_step_m},
                      {"loops_closed", lap.loops.closed},
                      {"loops_joined", lap.loops.joined},
                      {"loops_refused", lap.loops.refused},
                      {"map_version", lap.map_version},
                      {"keyframes", lap.map.keyframes},
                      {"landmarks", lap.map.landmarks},
                      {"ms_median", quantile(lap.ms, 0.5)},
                      {"ms_p99", quantile(lap.ms, 0.99)}});
    }
    return {{"scene", world_.options().scene},
            {"seed", world_.options().seed},
            {"lap_m", world_.scene().path.length_m()},
            {"ate_m", all.ate_m()},
            {"lost", all.lost},
            {"laps", laps}};
  }

 private:
  void add(const PoseEstimate& pose, const Rigid3& T_world_camera) {
    Lap& lap = laps_.back();
    ++lap.frames;
    lap.ms.push_back(pose.times.total_ms);
    lap.map = journey_.pipeline().map_size();
    lap.loops = journey_.pipeline().loops();
    lap.map_version = pose.map_version;
    if (!has_pose(pose)) {
      ++lap.lost;
      return;
    }
    lap.truth.push_back(T_world_camera.translation);
    lap.estimate.push_back(pose.T_world_camera.translation);
    const Eigen::Vector3d off = pose.T_world_camera.translation - T_world_camera.translation;
    lap.end_m = off.norm();
    lap.square += off.squaredNorm();
    lap.worst_m = std::max(lap.worst_m, lap.end_m);
    lap.worst_step_m = std::max(lap.worst_step_m, (off - off_before_).norm());
    off_before_ = off;
  }

  const synthetic::World& world_;
  synthetic::Renderer renderer_;
  Journey journey_;
  RgbdFrame frame_;
  std::vector<Lap> laps_;
  Eigen::Vector3d off_before_ = Eigen::Vector3d::Zero();  // error of the last pose
};

Status measure(const synthetic::SyntheticOptions& options, const std::vector<std::string>& settings,
               const std::string& out) {
  const Status valid = synthetic::validate(options);
  if (!valid) return valid.error();
  const Result<AppConfig> config = load_config("", settings);
  if (!config) return config.error();
  const Result<synthetic::World> world = synthetic::World::create(options);
  if (!world) return world.error();
  LapsBench bench(config->pipeline, *world);
  bench.drive();
  bench.print();
  if (out.empty()) return Done{};
  std::ofstream file(out);
  file << bench.json().dump(1) << '\n';
  file.close();
  if (!file) return Error{out + ": cannot be written"};
  return Done{};
}

}  // namespace
}  // namespace povslam

int main(int argc, char** argv) {
  povslam::synthetic::SyntheticOptions options;
  options.scene = "aisle";
  options.laps = 4.0;
  options.fps = 15.0;
  options.changes = false;
  std::vector<std::string> settings;
  std::string out;
  CLI::App cli{"The same route lap after lap: error, loops, size of the map, CPU of a frame, per lap.", "laps_bench"};
  cli.add_option("--scene", options.scene, "Simulated scene; nothing changes in it")->capture_default_str();
  cli.add_option("--seed", options.seed, "Simulated world")->capture_default_str();
  cli.add_option("--laps", options.laps, "To drive")->capture_default_str();
  cli.add_option("--fps", options.fps, "Frames a second")->capture_default_str();
  cli.add_option("--noise", options.noise, "Factor on all noise of the sensors: more drift")->capture_default_str();
  cli.add_option("--max-depth", options.max_depth_m, "Depth beyond it is missing [m]: more drift")
      ->capture_default_str();
  cli.add_option("--set", settings, "key=value of the configuration")->allow_extra_args(false);
  cli.add_option("--out", out, "Write the figures to this file as JSON");
  CLI11_PARSE(cli, argc, argv);
  const povslam::Status done = povslam::measure(options, settings, out);
  if (done) return 0;
  std::fprintf(stderr, "laps_bench: %s\n", done.error().message.c_str());
  return 1;
}
