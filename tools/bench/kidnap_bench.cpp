// A kidnapped camera in a simulated world: kidnap_bench --scene NAME (see --help). A drive makes the map; then the
// camera stands somewhere else all of a sudden, again and again, each time before a fresh copy of the map, and is
// judged against the truth: is it found within a second, and is any pose that it publishes wrong (by more than 0.3 m or
// 5 degrees)?
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>

#include "daemon/config_file.hpp"
#include "drivers/synthetic/synthetic_driver.hpp"
#include "tools/bench/kidnap_picture.hpp"
#include "tools/povslam/progress.hpp"

namespace povslam {
namespace {

struct Arguments {
  synthetic::SyntheticOptions world;
  int tries = 100;
  int frames = 30;  // of each try
  std::vector<std::string> places{"lap"};
  bool cold = false;
  double look_around_m = 0.0;
  std::uint64_t tries_seed = 1;
  std::vector<std::string> settings;
  std::string out;
};

class Bench {
 public:
  Bench(Arguments arguments, const PipelineOptions& options, synthetic::World world, TwinCheck twins)
      : arguments_(std::move(arguments)),
        options_(options),
        world_(std::move(world)),
        twins_(std::move(twins)),
        renderer_(world_),
        seen_(world_),
        calibration_(synthetic::sensor_calibrations(world_.options()).front()) {}

  void make_map() {
    Journey journey(options_, calibration_, world_.T_world_body(0.0));
    const double lap_s = world_.lap_end_s(arguments_.world.laps);
    Progress progress("map", 0);
    double square = 0.0, looked_m = 0.0, driven_m = 0.0;
    int posed = 0, lost = 0;
    const auto track = [&](const Rigid3& T_world_body) {
      const Rigid3 T = T_world_body * calibration_.T_body_sensor;
      const PoseEstimate& pose = journey.track(look(T));
      seen_.add(T, time_s_);
      progress.step();
      if (!has_pose(pose)) return void(++lost);
      ++posed;
      square += (pose.T_world_camera.translation - T.translation).squaredNorm();
    };
    for (double t = 0.0; t < lap_s; t += step_s()) {
      const Rigid3 T_world_body = world_.T_world_body(t);
      driven_m += (world_.T_world_body(t + step_s()).translation - T_world_body.translation).norm();
      track(T_world_body);
      if (arguments_.look_around_m <= 0.0 || driven_m - looked_m < arguments_.look_around_m) continue;
      looked_m = driven_m;
      if (t < world_.lap_end_s(1.0)) look_around(T_world_body, track);
    }
    map_ = journey.content();
    std::printf(
        "%s, seed %llu: map of %d keyframes, %d landmarks from %d frames; %d lost; ATE %.4f m; loops closed %d\n",
        arguments_.world.scene.c_str(), static_cast<unsigned long long>(arguments_.world.seed),
        journey.pipeline().map_size().keyframes, journey.pipeline().map_size().landmarks, posed + lost, lost,
        std::sqrt(square / std::max(1, posed)), journey.pipeline().loops().closed);
  }

  void run() {
    KidnapTries drawn(world_, time_s_, arguments_.tries_seed);
    Progress progress("tries", static_cast<std::size_t>(arguments_.tries));
    for (int i = 0; i < arguments_.tries; ++i) {
      const std::string& name = arguments_.places[static_cast<std::size_t>(i) % arguments_.places.size()];
      const auto place = std::find(std::begin(kPlaceNames), std::end(kPlaceNames), name) - std::begin(kPlaceNames);
      Try tried;
      tried.place = static_cast<Place>(place);
      const std::optional<Drift> drift = draw(tried.place, drawn);
      if (!drift) continue;
      tried.drift = *drift;
      look_up_truth(tried, drawn);
      kidnap(tried, drawn);
      tries_.push_back(tried);
      progress.step();
    }
  }

  void print() const {
    std::printf("%d tries, %s; each %d frames\n", static_cast<int>(tries_.size()),
                arguments_.cold ? "started on the map without a prior" : "kidnapped while tracking", arguments_.frames);
    std::map<std::string, Tally> rows;
    Tally all;
    for (const Try& tried : tries_) {
      const std::string place = kPlaceNames[static_cast<int>(tried.place)];
      const bool may_be_known = tried.known == Known::mapped || tried.known == Known::ambiguous;
      const bool elsewhere = may_be_known && tried.share.alike < kAlikeShare;
      rows[place + ", " + kKnownNames[static_cast<int>(tried.known)] + (elsewhere ? " otherwise" : "")].add(tried);
      all.add(tried);
    }
    Tally::print_head();
    for (const auto& [name, tally] : rows) tally.print(name);
    all.print("all");
    int uncovered = 0;
    for (const Try& tried : tries_) uncovered += tried.held_uncovered > 0;
    std::printf("old pose held before LOST was said: in %d tries, beyond three sigma of its own in %d\n",
                all.held_wrong, uncovered);
    std::printf("map read in %.0f ms (median); tracking CPU a frame %.1f ms (median), %.1f (p99), %.1f (most)\n\n",
                quantile(load_ms_, 0.5), static_cast<double>(quantile(frame_ms_, 0.5F)),
                static_cast<double>(quantile(frame_ms_, 0.99F)), static_cast<double>(quantile(frame_ms_, 1.0F)));
  }

  Status write() const {
    if (arguments_.out.empty()) return Done{};
    std::error_code failed;
    std::filesystem::create_directories(arguments_.out, failed);
    nlohmann::ordered_json json{{"scene", arguments_.world.scene},
                                {"seed", arguments_.world.seed},
                                {"start", arguments_.cold ? "cold" : "kidnapped"},
                                {"tries", nlohmann::json::array()}};
    for (const Try& tried : tries_) json["tries"].push_back(to_json(tried));
    const std::string stem = arguments_.out + "/" + arguments_.world.scene + "_" +
                             std::to_string(arguments_.world.seed) + (arguments_.cold ? "_cold" : "_kidnapped");
    std::ofstream file(stem + ".json");
    file << json.dump(1) << '\n';
    file.close();
    if (!file) return Error{stem + ".json: cannot be written"};
    const std::string title = arguments_.world.scene + ", seed " + std::to_string(arguments_.world.seed) + ", " +
                              (arguments_.cold ? "started without a prior" : "kidnapped") + ", " +
                              std::to_string(tries_.size()) + " tries";
    return draw_tries(stem + ".png", title, world_.scene(), time_s_, tries_);
  }

 private:
  static constexpr double kMappedShare = 0.2, kUnmappedShare = 0.02, kAmbiguousShare = 0.01;
  static constexpr double kAlikeShare = 0.1;  // less: known surfaces, but not as they are seen now
  static constexpr int kTruthEvery = 5;       // frames

  double step_s() const { return 1.0 / arguments_.world.fps; }

  const RgbdFrame& look(const Rigid3& T_world_camera) {
    time_s_ += step_s();
    renderer_.render(T_world_camera, time_s_, frame_);
    frame_.stamp = frame_.depth_stamp = world_.start_stamp() + from_seconds(time_s_);
    return frame_;
  }

  // Stops and turns on the spot, to the left, to the right and back.
  template <class Track>
  void look_around(const Rigid3& T_world_body, const Track& track) {
    constexpr double kReach_rad = 1.3, kSpeed_radps = 0.6;
    const double whole_s = 4.0 * kReach_rad / kSpeed_radps;
    for (double t = step_s(); t < whole_s; t += step_s()) {
      const double way = t * kSpeed_radps;
      const double angle = way < kReach_rad         ? way
                           : way < 3.0 * kReach_rad ? 2.0 * kReach_rad - way
                                                    : way - 4.0 * kReach_rad;
      track(T_world_body * Rigid3{so3_exp({0.0, 0.0, angle}), Eigen::Vector3d::Zero()});
    }
  }

  // On the lap only what looks at surfaces that the drive saw.
  std::optional<Drift> draw(Place place, KidnapTries& drawn) {
    const double seconds = (arguments_.frames - 1) * step_s();
    for (int attempt = 0; attempt < 100; ++attempt) {
      const std::optional<Drift> drift = drawn.draw(place, seconds);
      if (!drift || place != Place::lap) return drift;
      if (seen_.of(drift->T_world_camera(0.0), time_s_).seen < kMappedShare) continue;
      if (seen_.of(drift->T_world_camera(seconds), time_s_).seen >= kMappedShare) return drift;
    }
    return std::nullopt;
  }

  void look_up_truth(Try& tried, const KidnapTries& drawn) {
    double least = 1.0, most = 0.0, difference = 0.0;
    for (int i = 0; i < arguments_.frames; i += kTruthEvery) {
      const Rigid3 T = tried.drift.T_world_camera(i * step_s());
      const SeenSurfaces::Share share = seen_.of(T, time_s_);
      if (i == 0) tried.share = share;
      least = std::min(least, share.seen);
      most = std::max(most, share.seen);
      difference = std::max(difference, twins_.least_difference(T, time_s_, drawn));
    }
    tried.twin_difference = difference;
    tried.known = difference < kAmbiguousShare ? Known::ambiguous
                  : least >= kMappedShare      ? Known::mapped
                  : most < kUnmappedShare      ? Known::unmapped
                                               : Known::partly;
  }

  void kidnap(Try& tried, KidnapTries& drawn) {
    PipelineOptions options = options_;
    if (arguments_.cold) options.frontend.map.mode = "localise";
    std::unique_ptr<Journey> journey;
    bool tracking = false;
    for (int attempt = 0; attempt < 10 && !tracking; ++attempt) {
      const TimeNs begun = monotonic_now();
      journey = std::make_unique<Journey>(options, calibration_, Rigid3{}, &map_);
      load_ms_.push_back(to_ms(monotonic_now() - begun));
      if (arguments_.cold) break;
      tracking = settle(*journey, drawn.on_lap());
    }
    TryScore score(tried, options_.frontend.track.frames_to_lost, tracking);
    for (int i = 0; i < arguments_.frames; ++i) {
      const Rigid3 T = tried.drift.T_world_camera(i * step_s());
      const PoseEstimate& pose = journey->track(look(T));
      frame_ms_.push_back(pose.times.total_ms);
      score.add(pose, T);
    }
  }

  // Whether it came to track well where it was put first.
  bool settle(Journey& journey, Drift drift) {
    constexpr int kFrames = 45, kGood = 6;
    drift.speed_mps = 0.3;
    for (int i = 0, good = 0; i < kFrames && good < kGood; ++i) {
      const Rigid3 T = drift.T_world_camera(i * step_s());
      const PoseEstimate& pose = journey.track(look(T));
      good = pose.state == TrackState::ok && !error_of(pose.T_world_camera, T).wrong() ? good + 1 : 0;
      if (good == kGood) return true;
    }
    return false;
  }

  Arguments arguments_;
  PipelineOptions options_;
  synthetic::World world_;
  TwinCheck twins_;
  synthetic::Renderer renderer_;
  SeenSurfaces seen_;
  SensorCalibration calibration_;
  RgbdFrame frame_;
  MapContent map_;
  double time_s_ = 0.0;  // goes on through drive and tries
  std::vector<Try> tries_;
  std::vector<double> load_ms_;
  std::vector<float> frame_ms_;
};

Status measure(const Arguments& arguments) {
  const Status valid = synthetic::validate(arguments.world);
  if (!valid) return valid.error();
  const Result<AppConfig> config = load_config("", arguments.settings);
  if (!config) return config.error();
  Result<synthetic::World> world = synthetic::World::create(arguments.world);
  if (!world) return world.error();
  Result<TwinCheck> twins = TwinCheck::create(arguments.world);
  if (!twins) return twins.error();
  Bench bench(arguments, config->pipeline, std::move(*world), std::move(*twins));
  bench.make_map();
  bench.run();
  bench.print();
  return bench.write();
}

}  // namespace
}  // namespace povslam

int main(int argc, char** argv) {
  povslam::Arguments arguments;
  arguments.world.changes = false;
  CLI::App cli{"A kidnapped camera in a simulated world: found? wrongly?", "kidnap_bench"};
  cli.add_option("--scene", arguments.world.scene, "Simulated scene; nothing changes in it")->capture_default_str();
  cli.add_option("--seed", arguments.world.seed, "Simulated world")->capture_default_str();
  cli.add_option("--laps", arguments.world.laps, "Of the drive that makes the map")->capture_default_str();
  cli.add_option("--fps", arguments.world.fps, "Frames a second")->capture_default_str();
  cli.add_option("--look-around", arguments.look_around_m,
                 "On the first lap stop every so many metres and turn by 75 degrees to either side; 0: never")
      ->capture_default_str();
  cli.add_option("--tries", arguments.tries, "How often")->capture_default_str()->check(CLI::Range(1, 100'000));
  cli.add_option("--frames", arguments.frames, "Of each try")->capture_default_str()->check(CLI::Range(1, 1000));
  cli.add_option("--tries-seed", arguments.tries_seed, "Other tries of the same kind")->capture_default_str();
  cli.add_option("--places", arguments.places,
                 "In turns: lap (beside the lap, within 1 m and 60 degrees, looking at what the drive saw), anywhere, "
                 "other_room, bay")
      ->capture_default_str()
      ->check(CLI::IsMember({"lap", "anywhere", "other_room", "bay"}));
  cli.add_flag("--cold", arguments.cold, "Start on the map without a prior, read-only; else kidnap while tracking");
  cli.add_option("--set", arguments.settings, "key=value of the configuration")->allow_extra_args(false);
  cli.add_option("--out", arguments.out, "Folder for SCENE_SEED_START.json and .png");
  CLI11_PARSE(cli, argc, argv);
  const povslam::Status done = povslam::measure(arguments);
  if (done) return 0;
  std::fprintf(stderr, "kidnap_bench: %s\n", done.error().message.c_str());
  return 1;
}
