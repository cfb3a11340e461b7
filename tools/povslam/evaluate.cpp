// povslam evaluate: scores of a run against the truth, as JSON.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "drivers/replay/text_file.hpp"
#include "tools/povslam/plot.hpp"
#include "tools/povslam/scores/frame_list.hpp"
#include "tools/povslam/scores/pool.hpp"
#include "tools/povslam/scores/scene_report.hpp"
#include "tools/povslam/scores/trajectory_report.hpp"
#include "tools/povslam/subcommands.hpp"

namespace povslam {
namespace {

using Json = nlohmann::ordered_json;
using namespace scores;

struct EvaluateArguments {
  std::string gt, traj, truth, events, objects, map, reference_map, out, title;
  std::vector<std::string> plots, pool;
  TrajectoryReportOptions trajectory;
  SceneReportOptions scene;

  bool scores_scene() const { return !events.empty() || !objects.empty() || !map.empty(); }
};

// Wrong combinations of options; empty: none.
std::string usage_fault(const EvaluateArguments& arguments) {
  if (!arguments.pool.empty()) return "";
  if (arguments.traj.empty() && !arguments.scores_scene()) {
    return "nothing to score: give --traj, --events, --objects or --map";
  }
  if (!arguments.traj.empty() && arguments.gt.empty() && arguments.truth.empty()) return "--traj needs --gt or --truth";
  if (arguments.traj.empty() && !arguments.plots.empty()) return "--plot needs --traj";
  if (!(arguments.events.empty() && arguments.objects.empty()) && arguments.truth.empty()) {
    return "--events and --objects need --truth";
  }
  if (!arguments.map.empty() && arguments.truth.empty() && arguments.reference_map.empty()) {
    return "--map needs --truth or --reference-map";
  }
  if (!arguments.reference_map.empty() && arguments.map.empty()) return "--reference-map needs --map";
  return "";
}

std::string short_name(const std::filesystem::path& file) {
  return (file.parent_path().filename() / file.filename()).string();
}

Result<TrajectoryReport> evaluate_trajectory(const EvaluateArguments& arguments) {
  const std::string gt = arguments.gt.empty() ? arguments.truth + "/groundtruth.txt" : arguments.gt;
  const Result<std::vector<StampedPose>> truth = read_trajectory(gt);
  if (!truth) return truth.error();
  const Result<std::vector<StampedPose>> estimate = read_trajectory(arguments.traj);
  if (!estimate) return estimate.error();
  std::vector<TimeNs> stamps;
  if (!arguments.truth.empty()) {
    const Result<std::vector<ListedFrame>> frames = read_frame_list(arguments.truth);
    if (!frames) return frames.error();
    for (const ListedFrame& frame : *frames) stamps.push_back(frame.stamp);
  }
  Result<TrajectoryReport> report = report_trajectory(*truth, *estimate, stamps, arguments.trajectory);
  if (!report) return Error{arguments.traj + " against " + gt + ": " + report.error().message};
  report->plot.title = arguments.title.empty() ? short_name(arguments.traj) : arguments.title;
  for (const std::string& plot : arguments.plots) {
    if (const Status drawn = plot_trajectories(plot, report->plot); !drawn) return drawn.error();
  }
  return report;
}

Status evaluate_objects(const EvaluateArguments& arguments, const SceneTruth& truth, const Sightings& sightings,
                        const Rigid3& T_truth_estimate, Json& scores) {
  std::vector<ReportedObject> now;
  if (!arguments.objects.empty()) {
    auto objects = read_reported_objects(arguments.objects);
    if (!objects) return objects.error();
    now = std::move(*objects);
    scores["objects"] = report_objects(truth, &sightings, now, T_truth_estimate, arguments.scene);
  }
  if (!arguments.events.empty()) {
    const auto events = read_events(arguments.events);
    if (!events) return events.error();
    scores["events"] = report_events(truth, &sightings, *events, T_truth_estimate, arguments.scene);
    scores["events"]["moved"] = report_moved(truth, &sightings, *events, now, T_truth_estimate, arguments.scene);
  }
  return Done{};
}

Status evaluate_reference_map(const EvaluateArguments& arguments, const PlyMesh& map, const Rigid3& T_truth_estimate,
                              Json& scores) {
  const Result<PlyMesh> reference = read_ply(arguments.reference_map);
  if (!reference) return reference.error();
  const Result<Json> voxels = report_voxels_against_map(*reference, map, T_truth_estimate, arguments.scene);
  if (!voxels) return Error{arguments.map + ": " + voxels.error().message};
  scores["voxels_against_reference_map"] = *voxels;
  return Done{};
}

// Sections whose truth the sequence does not hold are left out.
Status evaluate_scene(const EvaluateArguments& arguments, const std::optional<SceneTruth>& truth,
                      const Rigid3& T_truth_estimate, Json& scores) {
  PlyMesh surface, map;
  const std::filesystem::path surface_file = std::filesystem::path(arguments.truth) / "final_surface.ply";
  if (!arguments.map.empty()) {
    Result<PlyMesh> read = read_ply(arguments.map);
    if (!read) return read.error();
    map = std::move(*read);
    if (!arguments.truth.empty() && is_file(surface_file)) {
      Result<PlyMesh> read_surface = read_ply(surface_file);
      if (!read_surface) return read_surface.error();
      surface = std::move(*read_surface);
    }
  }
  const bool wants_objects = truth && !(arguments.events.empty() && arguments.objects.empty());
  if (wants_objects || !surface.vertices.empty()) {
    const SceneTruth scene = truth.value_or(SceneTruth{});
    const Result<Sightings> sightings = count_sightings(arguments.truth, scene, surface);
    if (!sightings) return sightings.error();
    if (wants_objects) {
      if (const Status done = evaluate_objects(arguments, scene, *sightings, T_truth_estimate, scores); !done)
        return done;
    }
    if (!surface.vertices.empty()) {
      const Result<Json> voxels = report_voxels(surface, sightings->points, map, T_truth_estimate, arguments.scene);
      if (!voxels) return Error{arguments.map + ": " + voxels.error().message};
      scores["voxels"] = *voxels;
    }
  }
  return arguments.reference_map.empty() ? Status(Done{})
                                         : evaluate_reference_map(arguments, map, T_truth_estimate, scores);
}

Result<Json> evaluate(EvaluateArguments arguments) {
  if (!arguments.pool.empty()) return pool_scores(arguments.pool);
  std::optional<SceneTruth> truth;
  const std::filesystem::path truth_file = std::filesystem::path(arguments.truth) / "objects_truth.json";
  if (!arguments.truth.empty() && is_file(truth_file)) {
    const Result<SceneTruth> read = read_scene_truth(truth_file);
    if (!read) return read.error();
    truth = *read;
    arguments.trajectory.lap1_end = truth->lap1_end;
  }
  Json scores;
  Rigid3 T_truth_estimate;
  if (!arguments.traj.empty()) {
    const Result<TrajectoryReport> report = evaluate_trajectory(arguments);
    if (!report) return report.error();
    scores["trajectory"] = report->figures;
    T_truth_estimate = report->T_truth_estimate;
  }
  if (arguments.scores_scene()) {
    if (const Status done = evaluate_scene(arguments, truth, T_truth_estimate, scores); !done) return done.error();
  }
  return scores;
}

Status write_out(const Json& scores, const std::string& file) {
  const std::string text = scores.dump(2) + "\n";
  std::fputs(text.c_str(), stdout);
  if (file.empty()) return Done{};
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) return Error{file + ": cannot write; does its folder exist and may it be written to?"};
  return Done{};
}

int run(const EvaluateArguments& arguments) {
  const Result<Json> scores = evaluate(arguments);
  const Status done = scores ? write_out(*scores, arguments.out) : Status(scores.error());
  if (!done) std::fprintf(stderr, "povslam evaluate: %s\n", done.error().message.c_str());
  return done ? 0 : 1;
}

void add_file_options(CLI::App& command, EvaluateArguments& arguments) {
  command.add_option("--gt", arguments.gt, "True trajectory (TUM lines, T_world_camera); default: of --truth");
  command.add_option("--traj", arguments.traj, "Estimated trajectory (TUM lines)");
  command.add_option("--truth", arguments.truth, "Sequence folder: frame list, true objects and surfaces");
  command.add_option("--events", arguments.events, "events.jsonl of the run");
  command.add_option("--objects", arguments.objects, "objects.json of the run");
  command.add_option("--map", arguments.map, "map.ply of the run");
  command.add_option("--reference-map", arguments.reference_map, "Map made with true poses, as a second reference");
  command.add_option("--pool", arguments.pool, "Only pool these JSON files of earlier evaluations");
  command.add_option("--plot", arguments.plots, "Trajectory plot: .png, .svg, or a stem for both; repeatable")
      ->expected(1)
      ->take_all();
  command.add_option("--title", arguments.title, "Title of the plot");
  command.add_option("--out", arguments.out, "Write the JSON into this file, too");
}

// An option that takes one of some words.
template <class Value>
void choice(CLI::App& command, const std::string& option, const std::string& help, Value& chosen,
            const std::map<std::string, Value>& words) {
  command
      .add_option_function<std::string>(
          option, [words, &chosen](const std::string& word) { chosen = words.at(word); }, help)
      ->check(CLI::IsMember(words));
}

void add_scoring_options(CLI::App& command, EvaluateArguments& arguments) {
  choice<Alignment>(command, "--align", "Errors to print: first pose fixed, SE(3), or both",
                    arguments.trajectory.alignment,
                    {{"first", Alignment::first}, {"se3", Alignment::se3}, {"both", Alignment::both}});
  command.add_option("--max-gap-s", arguments.trajectory.max_gap_s, "Longest hole of the truth to interpolate [s]")
      ->check(CLI::Range(1e-6, 60.0));
  choice<Arrangement>(command, "--arrangement", "True objects: before or after the change", arguments.scene.arrangement,
                      {{"before", Arrangement::before}, {"after", Arrangement::after}});
  command.add_option("--voxel-size-m", arguments.scene.voxel_size_m, "Voxels' edge [m]")->check(CLI::Range(0.02, 5.0));
  command.add_option("--floor-z-m", arguments.scene.floor_z_m, "Height of the floor in the truth's world [m]")
      ->check(CLI::Range(-1000.0, 1000.0));
}

}  // namespace

void add_evaluate(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("evaluate", "Score a run against the truth; JSON on standard output");
  const auto arguments = std::make_shared<EvaluateArguments>();
  add_file_options(*command, *arguments);
  add_scoring_options(*command, *arguments);
  command->callback([arguments, &exit_code] {
    const std::string fault = usage_fault(*arguments);
    if (!fault.empty()) throw CLI::ValidationError("evaluate", fault);
    exit_code = run(*arguments);
  });
}

}  // namespace povslam
