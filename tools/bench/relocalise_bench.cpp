// How often, how well and how fast the camera is found without a prediction, and how often wrongly:
// relocalise_bench [--sequence FOLDER --camera NAME]. Simulated: a map is tracked along one lap; asked are views beside
// the path, views all around (of which the map knows some), and views of other worlds. Wrong: more than 0.3 m or
// 5 degrees off, or any answer in another world. Recorded: against where tracking the whole of it says it was.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "drivers/replay/trajectory_file.hpp"
#include "drivers/synthetic/random.hpp"
#include "pipeline/backend/smooth.hpp"
#include "pipeline/base/time.hpp"
#include "pipeline/frontend/relocalise.hpp"
#include "pipeline/frontend/track.hpp"
#include "tools/bench/scene_views.hpp"

namespace povslam {
namespace {

struct Arguments {
  std::vector<std::string> scenes{"static", "aisle"};
  std::vector<std::uint64_t> seeds{1, 2};
  std::string sequence, camera;
  int queries = 100;
  double fps = 15.0;
  double ask_at_lap = 0.0;
  bool verbose = false;
};

using Verdict = Relocaliser::Verdict;

// A map that is tracked frame by frame, then asked.
class Mapped {
 public:
  Mapped(const SensorCalibration& calibration, const Rigid3& T_world_camera_start)
      : camera_(calibration.camera),
        tracker_(calibration, {}, T_world_camera_start),
        builder_(camera_, {}),
        frame_(camera_, {}),
        index_(Vocabulary::shipped(), MapOptions{}.max_keyframes, OrbOptions{}.num_features),
        relocaliser_(camera_, {}) {}

  Rigid3 track(const RgbdFrame& image) {
    const Rigid3 T_world_camera = tracker_.track(image).T_world_camera;
    if (SmoothProblem* problem = tracker_.take_problem()) {
      smooth(*problem, {});
      tracker_.give_back(problem);
    }
    return T_world_camera;
  }
  void learn_words() {
    std::vector<std::uint32_t> words;
    const Map& map = tracker_.map();
    for (std::int32_t slot = 0; slot < map.keyframe_slots(); ++slot) {
      if (!map.keyframe(slot).alive) continue;
      words.resize(map.keyframe(slot).descriptor.size());
      Vocabulary::shipped().words(map.keyframe(slot).descriptor, words);
      index_.add(slot, words);
    }
  }
  Relocaliser::Answer ask(const RgbdFrame& image) {
    builder_.build(image, 1.0, frame_);
    const TimeNs begun = thread_cpu_now();
    relocaliser_.start_over();  // each frame by itself
    const auto answer = relocaliser_.search(tracker_.map(), index_, frame_);
    ms_.push_back(to_ms(thread_cpu_now() - begun));
    return answer;
  }
  const Map& map() const { return tracker_.map(); }
  const std::vector<double>& ms() const { return ms_; }

 private:
  PinholeCamera camera_;
  Tracker tracker_;
  FrameBuilder builder_;
  Frame frame_;
  PlaceIndex index_;
  Relocaliser relocaliser_;
  std::vector<double> ms_;
};

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

class Tally {
 public:
  Tally(std::string name, bool verbose) : name_(std::move(name)), verbose_(verbose) {}
  // truth: nothing where there is no right answer.
  void add(const Relocaliser::Answer& answer, const std::optional<Rigid3>& T_world_camera) {
    ++asked_;
    const Vector6d error =
        T_world_camera ? local(*T_world_camera, answer.fit.T_camera_world.inverse()) : Vector6d::Zero();
    const double off_m = error.head<3>().norm(), off_deg = error.tail<3>().norm() * 57.29577951;
    const bool right = T_world_camera && off_m <= 0.3 && off_deg <= 5.0;
    ambiguous_ += answer.verdict == Verdict::ambiguous ? 1 : 0;
    if (answer.verdict == Verdict::found) ++(right ? right_ : wrong_);
    if (answer.verdict == Verdict::found && right) off_m_.push_back(off_m), off_deg_.push_back(off_deg);
    if (answer.verdict == Verdict::found && !right) std::printf("  WRONG: %.2f m, %.1f deg\n", off_m, off_deg);
    if (verbose_ || (answer.verdict == Verdict::found && !right)) {
      const PlaceFit& fit = answer.fit;
      std::printf(
          "  %s %s: %d pairs, %d inliers, %d rival, %d of %d expected, share %.2f, %d contradicted, %d cells, missed "
          "%d of "
          "%d, "
          "thinnest %.3f; off %.3f m, %.2f deg\n",
          answer.verdict == Verdict::found       ? "found"
          : answer.verdict == Verdict::ambiguous ? "ambiguous"
                                                 : "unknown",
          right ? "right" : "wrong", fit.num_pairs, fit.num_inliers, fit.num_rival, fit.num_expected, fit.num_possible,
          fit.share(), fit.num_contradicted, fit.num_cells, fit.num_missed_cells, fit.num_expected_cells, fit.thinnest,
          off_m, off_deg);
    }
  }
  void print() const {
    std::printf("%-34s %5d %6d %6d %6d %8.4f %8.4f %8.3f %8.3f\n", name_.c_str(), asked_, right_, wrong_, ambiguous_,
                quantile(off_m_, 0.5), quantile(off_m_, 0.95), quantile(off_deg_, 0.5), quantile(off_deg_, 0.95));
  }

 private:
  std::string name_;
  bool verbose_;
  int asked_ = 0, right_ = 0, wrong_ = 0, ambiguous_ = 0;
  std::vector<double> off_m_, off_deg_;
};

void print_times(const Mapped& mapped) {
  std::printf("  %d keyframes, %d landmarks; search %.2f ms (median), %.2f (p95), %.2f (most)\n",
              mapped.map().num_keyframes(), mapped.map().num_landmarks(), quantile(mapped.ms(), 0.5),
              quantile(mapped.ms(), 0.95), quantile(mapped.ms(), 1.0));
}

void ask_scene(const Arguments& arguments, const std::string& scene, std::uint64_t seed) {
  SceneViews views(scene, seed);
  const double asked_s = arguments.ask_at_lap * views.lap_s();  // the world as it is then
  Mapped mapped(views.calibration(), views.world().T_world_camera(0.0));
  for (double t = 0.0; t < views.lap_s(); t += 1.0 / arguments.fps) {
    mapped.track(views.look(views.world().T_world_camera(t), t));
  }
  mapped.learn_words();
  const std::string name = scene + " " + std::to_string(seed);
  synthetic::Random random(synthetic::mix(seed, 99));
  const auto near_path = [&](SceneViews& world, double side_m, double turn_rad) {
    const double t = random.uniform(0.0, world.lap_s());
    const Rigid3 beside{so3_exp({random.uniform(-0.05, 0.05), random.uniform(-turn_rad, turn_rad), 0.0}),
                        {random.uniform(-side_m, side_m), random.uniform(-0.1, 0.1), random.uniform(-side_m, side_m)}};
    return world.world().T_world_camera(t) * beside;
  };
  Tally beside(name + ", beside the path", arguments.verbose), around(name + ", all around", arguments.verbose),
      other(name + ", other worlds", arguments.verbose);
  for (int q = 0; q < arguments.queries; ++q) {
    const Rigid3 T = near_path(views, 0.4, 0.35);
    beside.add(mapped.ask(views.look(T, asked_s + 0.01 * q)), T);
  }
  for (int q = 0; q < arguments.queries; ++q) {
    const Rigid3 T = near_path(views, 0.4, 3.14);
    around.add(mapped.ask(views.look(T, asked_s + 0.01 * q)), T);
  }
  for (const std::uint64_t more : {std::uint64_t{50}, std::uint64_t{51}}) {
    SceneViews elsewhere(scene, seed + more);
    for (int q = 0; q < arguments.queries; ++q) {
      other.add(mapped.ask(elsewhere.look(near_path(elsewhere, 0.4, 3.14), asked_s)), std::nullopt);
    }
  }
  beside.print();
  around.print();
  other.print();
  print_times(mapped);
}

Status ask_recording(const Arguments& arguments) {
  const auto truth = read_trajectory(arguments.sequence + "/groundtruth.txt");
  if (!truth) return truth.error();
  struct Seen {
    RgbdFrame image;
    Rigid3 T_world_camera;
  };
  std::vector<Seen> seen;
  SensorCalibration sensor;
  const Status read = for_each_frame(arguments.sequence, arguments.camera,
                                     [&](const SensorCalibration& calibration, const RgbdFrame& image) {
                                       sensor = calibration;
                                       if (const auto pose = pose_at(*truth, image.stamp, 0.1))
                                         seen.push_back({image, *pose});
                                     });
  if (!read) return read.error();
  if (seen.empty()) return Error{arguments.sequence + " has no frame with a true pose"};
  // The map is right by itself: how far it is from the truth is tracking's affair.
  const Rigid3 start = seen.front().T_world_camera;
  Mapped whole(sensor, start);
  for (Seen& s : seen) s.T_world_camera = whole.track(s.image);
  const auto run = [&](const std::string& name, std::size_t mapped_frames, std::size_t first, std::size_t step) {
    Mapped mapped(sensor, start);
    for (std::size_t i = 0; i < mapped_frames; ++i) mapped.track(seen[i].image);
    mapped.learn_words();
    Tally tally(name, arguments.verbose);
    for (std::size_t i = first; i < seen.size(); i += step)
      tally.add(mapped.ask(seen[i].image), seen[i].T_world_camera);
    tally.print();
    print_times(mapped);
  };
  run("recording, each 20th in the whole", seen.size(), 10, 20);
  run("recording, 2nd half in the first", seen.size() / 2, seen.size() / 2, 5);
  return Done{};
}

}  // namespace
}  // namespace povslam

int main(int argc, char** argv) {
  povslam::Arguments arguments;
  CLI::App cli{"How often, how well and how fast the camera is found without a prediction.", "relocalise_bench"};
  cli.add_option("--scenes", arguments.scenes, "Simulated scenes; none: '-'")->capture_default_str();
  cli.add_option("--seeds", arguments.seeds, "Simulated worlds")->capture_default_str();
  cli.add_option("--queries", arguments.queries, "Views of each kind")->capture_default_str();
  cli.add_option("--fps", arguments.fps, "Of the drive that makes the map")->capture_default_str();
  cli.add_option("--ask-at-lap", arguments.ask_at_lap,
                 "When the simulated world is asked about: in the second lap much has moved")
      ->capture_default_str();
  cli.add_option("--sequence", arguments.sequence, "Recorded sequence with groundtruth.txt");
  cli.add_option("--camera", arguments.camera, "Camera preset of the sequence");
  cli.add_flag("--verbose", arguments.verbose, "A line for each view");
  CLI11_PARSE(cli, argc, argv);
  std::printf("%-34s %5s %6s %6s %6s %8s %8s %8s %8s\n", "views", "asked", "right", "WRONG", "ambig.", "m p50", "p95",
              "deg p50", "p95");
  for (const std::string& scene : arguments.scenes) {
    for (const std::uint64_t seed : arguments.seeds) {
      if (scene != "-") povslam::ask_scene(arguments, scene, seed);
    }
  }
  if (arguments.sequence.empty()) return 0;
  if (const povslam::Status asked = povslam::ask_recording(arguments); !asked) {
    std::fprintf(stderr, "relocalise_bench: %s\n", asked.error().message.c_str());
    return 1;
  }
}
