// povslam replay: the pipeline over a recorded sequence.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <opencv2/core/utility.hpp>

#include "daemon/config_file.hpp"
#include "drivers/registry.hpp"
#include "tools/povslam/replay_output.hpp"
#include "tools/povslam/replay_run.hpp"
#include "tools/povslam/subcommands.hpp"

namespace povslam {
namespace {

struct ReplayArguments {
  std::string sequence, out, config, camera, frames, start, map;
  std::vector<std::string> overrides;
  bool realtime = false;
  std::string mode, poses = "estimated", labels;
};

constexpr int kFailure = 1;
constexpr int kBadUsage = 2;

int complain(const std::string& message, int exit_code) {
  std::fprintf(stderr, "povslam replay: %s\n", message.c_str());
  return exit_code;
}

DriverOptions driver_options(const ReplayArguments& arguments, const std::string& labels) {
  DriverOptions options{{"path", arguments.sequence}, {"realtime", arguments.realtime ? "true" : "false"}};
  if (!arguments.camera.empty()) options["camera"] = arguments.camera;
  if (!arguments.frames.empty()) options["frames"] = arguments.frames;
  if (labels == "auto" || labels == "replay") options["labels"] = labels == "auto" ? "auto" : "true";
  return options;
}

Result<ReplaySettings> settings_from(const ReplayArguments& arguments) {
  Result<AppConfig> config = load_config(arguments.config, arguments.overrides);
  if (!config) return config.error();
  ReplaySettings settings{std::move(*config), std::nullopt, arguments.map, {}};
  if (!arguments.labels.empty()) settings.config.pipeline.understanding.labels = arguments.labels;
  if (!arguments.mode.empty()) settings.config.pipeline.mode = arguments.mode;
  if (arguments.poses == "groundtruth") {
    if (arguments.realtime) return Error{"--poses groundtruth: not together with --realtime"};
    Result<std::vector<StampedPose>> truth =
        read_trajectory(std::filesystem::path(arguments.sequence) / "groundtruth.txt");
    if (!truth) return Error{"--poses groundtruth: " + truth.error().message};
    settings.true_poses = std::move(*truth);
  }
  if (!arguments.start.empty()) {
    const Result<Rigid3> start = parse_pose(arguments.start);
    if (!start) return Error{"--start " + start.error().message};
    settings.T_world_camera_start = *start;
  } else if (arguments.config.empty()) {
    settings.T_world_camera_start = settings.config.start.rigid() * level_forward_camera();
  }
  return settings;
}

void print_summary(const ReplayArguments& arguments, const ReplayRecord& record) {
  double total_ms = 0.0;
  for (const float ms : record.stages_ms[static_cast<std::size_t>(Stage::total)]) total_ms += static_cast<double>(ms);
  const double frames = static_cast<double>(std::max<std::size_t>(1, record.frames));
  std::printf("%zu frames: %zu tracked, %zu lost; %.2f ms of tracking CPU a frame, %.1f s in all -> %s\n",
              record.frames, record.tracked, record.lost, total_ms / frames, record.wall_s, arguments.out.c_str());
}

int replay(const ReplayArguments& arguments) {
  cv::setNumThreads(1);  // OpenCV's pool would add threads that nobody asked for, also beside --realtime's
  const Result<ReplaySettings> settings = settings_from(arguments);
  if (!settings) return complain(settings.error().message, kBadUsage);
  auto driver = make_driver("replay", driver_options(arguments, settings->config.pipeline.understanding.labels));
  if (!driver) return complain(driver.error().message, kBadUsage);
  const Status folder = make_output_folder(arguments.out, arguments.sequence);
  if (!folder) return complain(folder.error().message, kBadUsage);
  const Result<ReplayRecord> record = arguments.realtime ? replay_in_real_time(*settings, std::move(*driver))
                                                         : replay_in_one_thread(*settings, **driver);
  if (!record) return complain(record.error().message, kFailure);
  const Status written = write_replay(arguments.out, arguments.sequence, *record);
  if (!written) return complain(written.error().message, kFailure);
  print_summary(arguments, *record);
  return record->failure.empty() ? 0 : complain(record->failure, kFailure);
}

}  // namespace

void add_replay(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("replay", "Run the pipeline over a recorded sequence");
  const auto arguments = std::make_shared<ReplayArguments>();
  command->add_option("SEQUENCE", arguments->sequence, "Folder of the sequence (TUM RGB-D layout)")->required();
  command->add_option("--out", arguments->out, "Folder for the results")->required();
  command->add_option("--config", arguments->config, "Configuration file as povslamd's; default: the built-in values");
  command->add_option("--set", arguments->overrides, "key=value as in the configuration file; repeatable")
      ->allow_extra_args(false);
  command->add_option("--camera", arguments->camera,
                      "camera.yaml or tum1|tum2|tum3|7scenes|7scenes_registered, for a sequence without camera.yaml");
  command->add_option("--frames", arguments->frames, "A:B: only frames A to B - 1");
  command->add_option(
      "--start", arguments->start,
      "\"x y z qx qy qz qw\": T_world_camera of the first frame; default: level at the origin, along +x");
  command->add_option("--map", arguments->map, "Map on disk to begin with and to go on writing to; made if missing");
  command->add_flag("--realtime", arguments->realtime, "Pace by the stamps in the daemon's threads; late frames drop");
  command
      ->add_option(
          "--mode", arguments->mode,
          "pov: what is believed of objects decides what tracking hangs on; static: every feature counts alike")
      ->check(CLI::IsMember({"pov", "static"}));
  command
      ->add_option(
          "--poses", arguments->poses,
          "estimated: poses come from tracking; groundtruth: objects and map are made with the recording's true poses")
      ->check(CLI::IsMember({"estimated", "groundtruth"}));
  command
      ->add_option(
          "--labels", arguments->labels,
          "What tells things apart, else understanding.labels. auto: the recording's labels if it has any, else "
          "geometric; dnn: geometric, named by the network of network.file; off: nothing")
      ->check(CLI::IsMember({"auto", "replay", "geometric", "dnn", "off"}));
  command->callback([arguments, &exit_code] { exit_code = replay(*arguments); });
}

}  // namespace povslam
