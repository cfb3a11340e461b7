// povslam evaluate: scores of a run against the truth, as JSON.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/povslam/plot.hpp"
#include "tools/povslam/scores/frame_list.hpp"
#include "tools/povslam/scores/trajectory_report.hpp"
#include "tools/povslam/subcommands.hpp"

namespace povslam {
namespace {

using Json = nlohmann::ordered_json;

struct EvaluateArguments {
  std::string gt, traj, truth, out, title;
  std::vector<std::string> plots;
  TrajectoryReportOptions trajectory;
};

std::string short_name(const std::filesystem::path& file) {
  return (file.parent_path().filename() / file.filename()).string();
}

Result<Json> evaluate_trajectory(const EvaluateArguments& arguments) {
  const Result<std::vector<StampedPose>> truth = read_trajectory(arguments.gt);
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
  if (!report) return Error{arguments.traj + " against " + arguments.gt + ": " + report.error().message};
  report->plot.title = arguments.title.empty() ? short_name(arguments.traj) : arguments.title;
  for (const std::string& plot : arguments.plots) {
    if (const Status drawn = plot_trajectories(plot, report->plot); !drawn) return drawn.error();
  }
  return std::move(report->figures);
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

Status evaluate(const EvaluateArguments& arguments) {
  Json scores;
  const Result<Json> trajectory = evaluate_trajectory(arguments);
  if (!trajectory) return trajectory.error();
  scores["trajectory"] = *trajectory;
  return write_out(scores, arguments.out);
}

}  // namespace

void add_evaluate(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("evaluate", "Score a run against the truth; JSON on standard output");
  const auto arguments = std::make_shared<EvaluateArguments>();
  const std::map<std::string, Alignment> alignments{
      {"first", Alignment::first}, {"se3", Alignment::se3}, {"both", Alignment::both}};
  command->add_option("--gt", arguments->gt, "True trajectory (TUM lines, T_world_camera)")->required();
  command->add_option("--traj", arguments->traj, "Estimated trajectory (TUM lines)")->required();
  command->add_option("--truth", arguments->truth, "Sequence folder: frame list, true objects and surfaces");
  command->add_option("--plot", arguments->plots, "Trajectory plot: .png, .svg, or a stem for both; repeatable");
  command->add_option("--title", arguments->title, "Title of the plot");
  command->add_option("--out", arguments->out, "Write the JSON into this file, too");
  command->add_option("--align", arguments->trajectory.alignment, "Errors to print: first pose fixed, SE(3), or both")
      ->transform(CLI::CheckedTransformer(alignments));
  command->add_option("--max-gap-s", arguments->trajectory.max_gap_s, "Longest hole of the truth to interpolate [s]")
      ->check(CLI::PositiveNumber);
  command->callback([arguments, &exit_code] {
    const Status done = evaluate(*arguments);
    if (!done) std::fprintf(stderr, "povslam evaluate: %s\n", done.error().message.c_str());
    exit_code = done ? 0 : 1;
  });
}

}  // namespace povslam
