// povslam map: looks into a map on disk, also while the daemon writes to it.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/povslam/event_json.hpp"
#include "tools/povslam/map_info.hpp"
#include "tools/povslam/map_occupancy.hpp"
#include "tools/povslam/map_ply.hpp"
#include "tools/povslam/subcommands.hpp"

namespace povslam {
namespace {

struct MapArguments {
  std::string store, ply, occupancy;
  bool json = false, keyframes = false;
  OccupancyOptions options;
};

constexpr int kFailure = 1;
constexpr int kBadUsage = 2;

int complain(const std::string& message, int exit_code) {
  std::fprintf(stderr, "povslam map: %s\n", message.c_str());
  return exit_code;
}

Result<MapReport> read_map(const std::string& file) {
  Result<MapStore> store = MapStore::open(file, StoreMode::read_only);
  if (!store) return store.error();
  Result<StoreInfo> info = store->info();
  if (!info) return info.error();
  Result<MapContent> content = store->load();
  if (!content) return content.error();
  Result<WorldContent> world = store->load_world();
  if (!world) return world.error();
  return MapReport{store->file(), std::move(*info), std::move(*content), std::move(*world)};
}

int show_info(const MapArguments& arguments) {
  const Result<MapReport> report = read_map(arguments.store);
  if (!report) return complain(report.error().message, kFailure);
  const std::string text = arguments.json ? map_info_json(*report).dump(2) + "\n" : map_info_text(*report);
  std::fputs(text.c_str(), stdout);
  return 0;
}

int show_events(const MapArguments& arguments) {
  Result<MapStore> store = MapStore::open(arguments.store, StoreMode::read_only);
  if (!store) return complain(store.error().message, kFailure);
  const Result<WorldContent> world = store->load_world();
  if (!world) return complain(world.error().message, kFailure);
  for (const ObjectEvent& event : world->events) std::printf("%s\n", event_json(event).dump().c_str());
  return 0;
}

// Rows whose other half is missing are no damage, but somebody should know.
std::uint64_t rows_left_out(const MapReport& report) {
  const MapContent& map = report.content;
  std::uint64_t left_out = 0;
  for (const StoreInfo::Rows& table : report.store.tables) {
    const std::string name = table.table;
    if (name == "features") left_out += table.rows - map.features.size();
    if (name == "keyframes") left_out += table.rows - map.keyframes.size();
    if (name == "landmarks") left_out += table.rows - map.landmarks.size();
    if (name == "looks") left_out += table.rows - map.looks.size();
    if (name == "voxel_blocks") left_out += table.rows - report.world.blocks.size();
  }
  return left_out;
}

int verify(const MapArguments& arguments) {
  const Result<MapReport> report = read_map(arguments.store);
  if (!report) return complain(report.error().message, kFailure);
  std::printf("%s: sound; commit %llu, %zu keyframes, %zu landmarks, %zu objects, %zu events", report->file.c_str(),
              static_cast<unsigned long long>(report->store.commits), report->content.keyframes.size(),
              report->content.landmarks.size(), report->world.objects.size(), report->world.events.size());
  const std::uint64_t left_out = rows_left_out(*report);
  if (left_out > 0)
    std::printf("; %llu rows without their other half are not used", static_cast<unsigned long long>(left_out));
  std::printf("\n");
  return 0;
}

int export_map(const MapArguments& arguments) {
  if (arguments.ply.empty() && arguments.occupancy.empty())
    return complain("export: say --ply or --occupancy", kBadUsage);
  if (arguments.options.min_height_m >= arguments.options.max_height_m) {
    return complain("export: --min-height must be below --max-height", kBadUsage);
  }
  const Result<MapReport> report = read_map(arguments.store);
  if (!report) return complain(report.error().message, kFailure);
  if (!arguments.ply.empty()) {
    const Status written = write_map_ply(arguments.ply, report->content, arguments.keyframes);
    if (!written) return complain(written.error().message, kFailure);
  }
  if (arguments.occupancy.empty()) return 0;
  const Result<OccupancyGrid> grid = occupancy_of(report->content, arguments.options);
  if (!grid) return complain(arguments.store + ": " + grid.error().message, kFailure);
  const Status written = write_occupancy(arguments.occupancy, *grid);
  return written ? 0 : complain(written.error().message, kFailure);
}

}  // namespace

void add_map(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("map", "Look into a map on disk, also while the daemon writes to it");
  command->require_subcommand(1);
  const auto arguments = std::make_shared<MapArguments>();
  const auto add = [&](const char* name, const char* what, int (*run)(const MapArguments&)) {
    CLI::App* action = command->add_subcommand(name, what);
    action->add_option("STORE", arguments->store, "The map's file, as in the configuration's map.store")->required();
    action->callback([arguments, run, &exit_code] { exit_code = run(*arguments); });
    return action;
  };
  add("info", "What it holds: sizes, counts, versions, extent, times", show_info)
      ->add_flag("--json", arguments->json, "For programs");
  add("verify", "Read and check all of it; exit code 1 and what is wrong if it is damaged", verify);
  add("events", "What came, moved and went, ever: one JSON object a line, as in events.jsonl", show_events);
  CLI::App* action = add("export", "Write it in other programs' forms", export_map);
  action->add_option("--ply", arguments->ply, "File for the landmarks as points (binary PLY)");
  action->add_flag("--keyframes", arguments->keyframes, "With --ply: the keyframes as red points as well");
  action->add_option("--occupancy", arguments->occupancy,
                     "BASE: a floor plan for ROS' map_server, BASE.pgm and BASE.yaml");
  OccupancyOptions& options = arguments->options;
  action->add_option("--resolution", options.resolution_m, "Edge of a cell [m]")
      ->check(CLI::Range(0.005, 10.0))
      ->capture_default_str();
  action->add_option("--min-height", options.min_height_m, "What lies lower is floor [m, world z]")
      ->check(CLI::Range(-1000.0, 1000.0))
      ->capture_default_str();
  action->add_option("--max-height", options.max_height_m, "What lies higher is out of the way [m, world z]")
      ->check(CLI::Range(-1000.0, 1000.0))
      ->capture_default_str();
}

}  // namespace povslam
