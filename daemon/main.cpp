// povslamd: reads its configuration, opens its camera and publishes where the robot is, until it is told to stop.
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "daemon/app.hpp"
#include "daemon/config_file.hpp"
#include "daemon/config_keys.hpp"
#include "daemon/log_setup.hpp"
#include "daemon/publisher.hpp"
#include "daemon/service.hpp"
#include "daemon/stop_signal.hpp"
#include "drivers/registry.hpp"
#include "pipeline/base/log.hpp"

namespace povslam {
namespace {

constexpr const char* kSystemConfig = "/etc/povslam/povslam.toml";
constexpr int kFailure = 1;
constexpr int kBadUsage = 2;

struct Arguments {
  std::string config;
  std::vector<std::string> overrides;
  std::string start;
  bool print_config = false, check = false;
};

// What one thread has freed another may use: by default each has a heap of its own, and keeps it at its largest. They
// hardly meet there, and tracking does not come at all. What is large goes back to the system at once; by default the
// first large piece that is freed makes malloc keep all others.
void keep_little_free_memory() {
  constexpr int kHeaps = 2, kLarge_bytes = 256 * 1024;
  mallopt(M_ARENA_MAX, kHeaps);
  mallopt(M_MMAP_THRESHOLD, kLarge_bytes);
}

int complain(const Error& error, int exit_code) {
  std::fprintf(stderr, "povslamd: %s\n", error.message.c_str());
  return exit_code;
}

int run(const AppConfig& config, AppOptions options) {
  StopSignal stop;
  const Status logging = set_up_log(config.log);
  if (!logging) return complain(logging.error(), kFailure);
  Service service;
  options.sinks.push_back(&service);
  std::unique_ptr<Publisher> publisher;
  if (!config.lcm.url.empty()) {
    auto opened = Publisher::open(config.lcm);
    if (!opened) return complain(opened.error(), kFailure);
    publisher = std::move(*opened);
    options.sinks.push_back(publisher.get());
  }
  if (config.daemon.exit_at_end) options.on_end = [&stop] { stop.request(); };
  auto app = App::start(config, std::move(options));
  if (!app) return complain(app.error(), kFailure);
  malloc_trim(0);  // what reading the map took: 25 MB after two laps of an aisle
  service.ready();
  stop.wait();
  service.stopping();
  (*app)->stop();
  return 0;
}

int main_with(const Arguments& arguments) {
  if (arguments.print_config) {
    std::fputs(default_config_text().c_str(), stdout);
    return 0;
  }
  const Result<AppConfig> config = load_config(arguments.config, arguments.overrides);
  if (!config) return complain(config.error(), kBadUsage);
  AppOptions options;
  if (!arguments.start.empty()) {
    const Result<Rigid3> start = parse_pose(arguments.start);
    if (!start) return complain({"--start " + start.error().message}, kBadUsage);
    options.T_world_camera_start = *start;
  }
  const SensorConfig& sensor = config->sensors[0];
  auto driver = make_driver(sensor.driver, sensor.options);
  if (!driver) return complain({sensor.locate(driver.error().message)}, kBadUsage);
  if (arguments.check) return 0;
  options.driver = std::move(*driver);
  options.map_store = store_file(config->map, std::getenv("STATE_DIRECTORY"));
  return run(*config, std::move(options));
}

}  // namespace
}  // namespace povslam

int main(int argc, char** argv) {
  povslam::keep_little_free_memory();
  povslam::Arguments arguments;
  if (std::filesystem::exists(povslam::kSystemConfig)) arguments.config = povslam::kSystemConfig;
  CLI::App cli{"povslamd: publishes where the robot is, from its cameras, over LCM.", "povslamd"};
  cli.set_version_flag("--version", POVSLAM_VERSION);
  cli.add_option(
      "--config", arguments.config,
      "Configuration file (TOML); without it " + std::string(povslam::kSystemConfig) + ", else the defaults");
  cli.add_option("--set", arguments.overrides, "key=value as in the file, for example --set lcm.robot_id=r2")
      ->allow_extra_args(false);
  cli.add_option("--start", arguments.start,
                 "\"x y z qx qy qz qw\": T_world_camera of the first frame, in place of [start]");
  cli.add_flag("--print-config", arguments.print_config, "Print the documented default configuration and exit");
  cli.add_flag("--check", arguments.check, "Check the configuration and exit");
  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return cli.exit(error) == 0 ? 0 : povslam::kBadUsage;
  }
  return povslam::main_with(arguments);
}
