// CPU of the tracking thread a frame, beside cv::ORB alone on the same frames, in turns so that a busy machine
// disturbs both alike: tracking_bench [--sequence FOLDER [--camera NAME]] [--frames N] (see --help).
// Frames are rendered or decoded beforehand. Local bundle adjustment runs on a thread of its own, as in the daemon.
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <thread>
#include <vector>

#include "daemon/app.hpp"
#include "drivers/registry.hpp"
#include "pipeline/backend/smooth.hpp"
#include "pipeline/base/spsc_ring.hpp"
#include "pipeline/pipeline.hpp"

namespace povslam {
namespace {

struct Arguments {
  std::string sequence, camera, scene = "static";
  std::vector<int> features{1000, 4000};
  int frames = 450;
  int seed = 1;
  OrbOptions orb;  // its thresholds
};

struct Recording {
  std::string description;
  SensorCalibration calibration;
  std::vector<RgbdFrame> frames;
  std::vector<cv::Mat> grey;
  double feeder_ms = 0.0;  // CPU a frame
};

double resident_mb() {
  std::ifstream file("/proc/self/statm");
  double pages = 0.0, resident = 0.0;
  file >> pages >> resident;
  return resident * 4096e-6;
}

double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024e-6;
}

// Nearest rank.
float quantile(std::vector<float> values, double share) {
  if (values.empty()) return 0.0F;
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  return values[std::max<std::size_t>(rank, 1) - 1];
}

void print_row(const std::string& name, const std::vector<float>& ms) {
  const float median = quantile(ms, 0.5), p99 = quantile(ms, 0.99);
  std::printf("  %-26s %7.2f %7.2f %7.2f %7.2f    %4.2f\n", name.c_str(), static_cast<double>(median),
              static_cast<double>(quantile(ms, 0.95)), static_cast<double>(p99), static_cast<double>(quantile(ms, 1.0)),
              static_cast<double>(p99 / std::max(median, 1e-6F)));
}

// One pipeline with the thread that solves its problems, handed over through rings as in the daemon.
class Tracked {
 public:
  Tracked(const SensorCalibration& calibration, const OrbOptions& orb, int num_features)
      : num_features_(num_features), calibration_(calibration), started_(monotonic_now()) {
    options_.frontend.orb = orb;
    options_.frontend.orb.num_features = num_features;
    pipeline_ = std::make_unique<Pipeline>(options_, calibration_, Rigid3{});
    backend_ = std::jthread([this] { solve(); });
  }
  ~Tracked() { finish(); }

  // Ends the backend thread; call before print().
  void finish() {
    asked_.close();
    if (backend_.joinable()) backend_.join();
  }

  void track(const RgbdFrame& frame) {
    const TimeNs begun = thread_cpu_now();
    while (const auto job = solved_.try_pop()) pipeline_->give_back(*job);
    const PoseEstimate& pose = pipeline_->localise(frame);
    const bool has_pose = pose.state == TrackState::ok || pose.state == TrackState::degraded;
    const StageTimes& times = pose.times;
    while (const auto job = pipeline_->take_job()) {
      if (!asked_.try_push(BackendJob(*job))) pipeline_->give_back(*job);
    }
    total_ms_.push_back(static_cast<float>(to_ms(thread_cpu_now() - begun)));
    features_ms_.push_back(times.features_ms);
    track_ms_.push_back(times.track_ms);
    found_.push_back(static_cast<float>(pose.num_features));
    if (pose.keyframe) keyframe_ms_.push_back(times.keyframe_ms);
    if (total_ms_.size() == 1) first_pose_ms_ = to_ms(monotonic_now() - started_);
    tracked_ += has_pose ? 1 : 0;
  }

  void print() const {
    const MapSize map = pipeline_->map_size();
    std::printf(
        "\n%d features wanted, %.0f found (median); %d of %zu frames tracked, %d keyframes, %d landmarks; "
        "start to first pose %.0f ms\n",
        num_features_, static_cast<double>(quantile(found_, 0.5)), tracked_, total_ms_.size(), map.keyframes,
        map.landmarks, first_pose_ms_);
    print_row("tracking thread", total_ms_);
    print_row("  features", features_ms_);
    print_row("  matching and pose", track_ms_);
    print_row("  map upkeep at a keyframe", keyframe_ms_);
    print_row("backend thread, a problem", backend_ms_);
  }

 private:
  void solve() {
    while (auto job = asked_.pop()) {
      const TimeNs begun = thread_cpu_now();
      povslam::solve(*job, options_.backend);
      backend_ms_.push_back(static_cast<float>(to_ms(thread_cpu_now() - begun)));
      solved_.try_push(std::move(*job));
    }
  }

  int num_features_;
  SensorCalibration calibration_;
  PipelineOptions options_;
  TimeNs started_;
  std::unique_ptr<Pipeline> pipeline_;
  SpscRing<BackendJob> asked_{8}, solved_{8};
  std::vector<float> total_ms_, features_ms_, track_ms_, keyframe_ms_, found_;
  std::vector<float> backend_ms_;  // backend thread, until it has ended
  double first_pose_ms_ = 0.0;
  int tracked_ = 0;
  std::jthread backend_;
};

class OpencvOrb {
 public:
  OpencvOrb(int num_features, int fast_threshold)
      : orb_(cv::ORB::create(num_features, 1.2F, 8, 31, 0, 2, cv::ORB::HARRIS_SCORE, 31, fast_threshold)) {}
  void extract(const cv::Mat& grey) {
    const TimeNs begun = thread_cpu_now();
    orb_->detectAndCompute(grey, cv::noArray(), points_, descriptors_);
    ms_.push_back(static_cast<float>(to_ms(thread_cpu_now() - begun)));
    found_.push_back(static_cast<float>(points_.size()));
  }
  void print() const {
    const int found = static_cast<int>(quantile(found_, 0.5F));
    print_row("cv::ORB alone, " + std::to_string(found) + " found", ms_);
  }

 private:
  cv::Ptr<cv::ORB> orb_;
  std::vector<cv::KeyPoint> points_;
  cv::Mat descriptors_;
  std::vector<float> ms_, found_;
};

Result<Recording> record(const Arguments& arguments) {
  DriverOptions options{{"realtime", "false"}};
  if (arguments.sequence.empty()) {
    options.insert({{"scene", arguments.scene}, {"seed", std::to_string(arguments.seed)}, {"fps", "30"}});
  } else {
    options["path"] = arguments.sequence;
    if (!arguments.camera.empty()) options["camera"] = arguments.camera;
  }
  auto driver = make_driver(arguments.sequence.empty() ? "synthetic" : "replay", options);
  if (!driver) return driver.error();
  Result<DriverSetup> setup = (*driver)->open();
  if (!setup) return setup.error();
  Recording recording{setup->description, setup->sensors[0], {}, {}, 0.0};
  recording.calibration.T_body_sensor = level_forward_camera();
  const TimeNs begun = thread_cpu_now();
  SensorFrame frame;
  while (recording.frames.size() < static_cast<std::size_t>(arguments.frames)) {
    const Next next = (*driver)->next(frame);
    if (next.kind == Next::Kind::failed) return Error{next.message};
    if (next.kind == Next::Kind::end) break;
    if (next.kind == Next::Kind::frame && frame.kind == SensorKind::rgbd) {
      recording.frames.push_back(std::move(frame.rgbd));
      frame.rgbd = {};
    }
  }
  if (recording.frames.empty()) return Error{recording.description + " has no frames"};
  recording.feeder_ms = to_ms(thread_cpu_now() - begun) / static_cast<double>(recording.frames.size());
  for (RgbdFrame& taken : recording.frames) {
    const cv::Mat colour(taken.color.height(), taken.color.width(), CV_8UC3, taken.color.data());
    cv::cvtColor(colour, recording.grey.emplace_back(), cv::COLOR_RGB2GRAY);
  }
  return recording;
}

void measure(const Recording& recording, const OrbOptions& orb, const std::vector<int>& features) {
  const double before_mb = resident_mb();
  std::vector<std::unique_ptr<Tracked>> tracked;
  std::vector<OpencvOrb> yardsticks;
  for (const int number : features) yardsticks.emplace_back(number, orb.fast_threshold);
  for (const int number : features) {
    tracked.push_back(std::make_unique<Tracked>(recording.calibration, orb, number));
    tracked.back()->track(recording.frames[0]);
  }
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    for (std::size_t k = 0; k < features.size(); ++k) {
      if (i > 0) tracked[k]->track(recording.frames[i]);
      yardsticks[k].extract(recording.grey[i]);
    }
  }
  std::printf("%s: %zu frames of %d x %d; feeder %.2f ms of CPU a frame, beforehand\n", recording.description.c_str(),
              recording.frames.size(), recording.calibration.camera.width, recording.calibration.camera.height,
              recording.feeder_ms);
  std::printf("  %-26s %7s %7s %7s %7s    %s\n", "CPU [ms]", "median", "p95", "p99", "max", "p99/median");
  for (std::size_t k = 0; k < features.size(); ++k) {
    tracked[k]->finish();
    tracked[k]->print();
    yardsticks[k].print();
  }
  std::printf("\npeak memory %.0f MB, of which %.0f MB were there before (frames held beforehand)\n", peak_mb(),
              before_mb);
}

}  // namespace
}  // namespace povslam

int main(int argc, char** argv) {
  povslam::Arguments arguments;
  CLI::App cli{"CPU of the tracking thread a frame, beside cv::ORB alone on the same frames.", "tracking_bench"};
  cli.add_option("--sequence", arguments.sequence, "Recorded sequence; default: simulated");
  cli.add_option("--camera", arguments.camera, "Camera preset, for a sequence without camera.yaml");
  cli.add_option("--scene", arguments.scene, "Simulated scene")->capture_default_str();
  cli.add_option("--seed", arguments.seed, "Simulated world")->capture_default_str();
  cli.add_option("--frames", arguments.frames, "At most so many frames (1.5 MB each)")
      ->capture_default_str()
      ->check(CLI::Range(1, 100'000));
  cli.add_option("--features", arguments.features, "Features wanted of an image; each runs in turn")
      ->capture_default_str()
      ->check(CLI::Range(50, 20'000));
  cli.add_option("--fast-threshold", arguments.orb.fast_threshold,
                 "orb.fast_threshold, cv::ORB's too: lower where images are too poor for the features wanted")
      ->capture_default_str()
      ->check(CLI::Range(1, 254));
  cli.add_option("--min-fast-threshold", arguments.orb.min_fast_threshold, "orb.min_fast_threshold")
      ->capture_default_str()
      ->check(CLI::Range(1, 254));
  CLI11_PARSE(cli, argc, argv);
  cv::setNumThreads(1);
  const auto recording = povslam::record(arguments);
  if (!recording) {
    std::fprintf(stderr, "tracking_bench: %s\n", recording.error().message.c_str());
    return 1;
  }
  povslam::measure(*recording, arguments.orb, arguments.features);
}
