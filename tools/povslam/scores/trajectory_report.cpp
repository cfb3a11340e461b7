#include "tools/povslam/scores/trajectory_report.hpp"

#include <algorithm>
#include <cstdio>

namespace povslam::scores {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const PoseErrors& errors) {
  return {{"ate_rmse_m", errors.rmse_m},
          {"ate_mean_m", errors.mean_m},
          {"ate_median_m", errors.median_m},
          {"mpe_m", errors.max_m},
          {"rotation_rmse_deg", errors.rotation_rmse_deg},
          {"poses", errors.poses}};
}

Json frames_json(const MatchedTrajectory& matched, bool frames_known) {
  const double total = static_cast<double>(std::max<std::size_t>(1, matched.total_frames));
  Json json{{"counted", frames_known ? "frames of the sequence" : "truth stamps inside the estimate's span"},
            {"total", matched.total_frames},
            {"with_estimate", matched.tracked_frames},
            {"coverage", static_cast<double>(matched.tracked_frames) / total}};
  if (frames_known) json["held_with_last_pose"] = matched.held_frames;
  if (frames_known) json["before_first_estimate"] = matched.frames_before_first;
  json["without_truth"] = matched.frames_without_truth;
  return json;
}

Json laps_json(std::span<const ScoredPose> poses, TimeNs lap1_end, const Rigid3& T_truth_estimate) {
  const auto split = std::partition_point(poses.begin(), poses.end(),
                                          [lap1_end](const ScoredPose& pose) { return pose.stamp <= lap1_end; });
  const std::size_t in_lap1 = static_cast<std::size_t>(split - poses.begin());
  return {{"lap1", to_json(pose_errors(poses.first(in_lap1), T_truth_estimate))},
          {"lap2", to_json(pose_errors(poses.subspan(in_lap1), T_truth_estimate))}};
}

Json errors_json(const MatchedTrajectory& matched, const Rigid3& T_truth_estimate,
                 const TrajectoryReportOptions& options) {
  Json json = to_json(pose_errors(matched.poses, T_truth_estimate));
  if (matched.held_frames > 0) {
    std::vector<ScoredPose> tracked;
    std::copy_if(matched.poses.begin(), matched.poses.end(), std::back_inserter(tracked),
                 [](const ScoredPose& pose) { return !pose.held; });
    json["without_held_frames"] = to_json(pose_errors(tracked, T_truth_estimate));
  }
  if (options.lap1_end) json.update(laps_json(matched.poses, *options.lap1_end, T_truth_estimate));
  return json;
}

std::string format(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

TrajectoryPlot plot_of(const std::vector<StampedPose>& truth, const std::vector<StampedPose>& estimate,
                       const Rigid3& T_truth_estimate, const Json& figures, const char* shown,
                       const TrajectoryReportOptions& options) {
  TrajectoryPlot plot;
  plot.truth = truth;
  plot.lap1_end = options.lap1_end;
  plot.max_gap_s = options.max_gap_s;
  plot.estimates.push_back({"estimate", estimate});
  for (StampedPose& pose : plot.estimates.back().poses) pose.T_world_sensor = T_truth_estimate * pose.T_world_sensor;
  const auto note = [&plot](const char* name, const char* pattern, const Json& value) {
    plot.notes.push_back(std::string(name) + ": " + format(pattern, value.get<double>()));
  };
  const Json& errors = figures[shown];
  plot.notes.push_back(std::string("alignment: ") +
                       (shown == std::string("aligned") ? "SE(3), best fit" : "first pose fixed"));
  note("ATE RMSE", "%.4f m", errors["ate_rmse_m"]);
  note("maximum position error", "%.4f m", errors["mpe_m"]);
  note("rotation RMSE", "%.3f deg", errors["rotation_rmse_deg"]);
  if (figures.contains("aligned") && figures.contains("first_fixed")) {
    note("ATE RMSE, SE(3)-aligned", "%.4f m", figures["aligned"]["ate_rmse_m"]);
  }
  if (figures["rpe"]["pairs"].get<std::size_t>() > 0) {
    const std::string over = format(" over %g s", options.rpe_window_s);
    note(("RPE translation" + over).c_str(), "%.4f m", figures["rpe"]["translation_rmse_m"]);
    note(("RPE rotation" + over).c_str(), "%.3f deg", figures["rpe"]["rotation_rmse_deg"]);
  }
  note("frames with a pose", "%.1f %%", figures["frames"]["coverage"].get<double>() * 100.0);
  return plot;
}

}  // namespace

Result<TrajectoryReport> report_trajectory(const std::vector<StampedPose>& truth,
                                           const std::vector<StampedPose>& estimate, const std::vector<TimeNs>& frames,
                                           const TrajectoryReportOptions& options) {
  const MatchedTrajectory matched = match_trajectories(truth, estimate, frames, options.max_gap_s);
  if (matched.poses.empty()) {
    return Error{"no pose of the estimate has ground truth within " + format("%g", options.max_gap_s) +
                 " s: do both files (and the sequence's frame list) use the same clock?"};
  }
  const Rigid3 T_first = fix_first_pose(matched.poses);
  const std::optional<Rigid3> T_aligned = align_positions(matched.poses);
  const bool show_aligned = options.alignment != Alignment::first && T_aligned.has_value();
  const bool show_first = options.alignment != Alignment::se3 || !show_aligned;
  Json figures;
  if (show_first) figures["first_fixed"] = errors_json(matched, T_first, options);
  if (show_aligned) figures["aligned"] = errors_json(matched, *T_aligned, options);
  figures["rotation_aligned_rmse_deg"] = pose_errors(matched.poses, align_rotations(matched.poses)).rotation_rmse_deg;
  const RelativeErrors relative = relative_errors(matched.poses, options.rpe_window_s);
  figures["rpe"] = {{"window_s", options.rpe_window_s},
                    {"translation_rmse_m", relative.translation_rmse_m},
                    {"rotation_rmse_deg", relative.rotation_rmse_deg},
                    {"pairs", relative.pairs}};
  const StandstillErrors standstill = standstill_errors(matched.poses);
  figures["pose_that_never_moves"] = {{"first_fixed_ate_rmse_m", standstill.first_fixed_rmse_m},
                                      {"aligned_ate_rmse_m", standstill.aligned_rmse_m}};
  figures["frames"] = frames_json(matched, !frames.empty());
  TrajectoryReport report;
  report.plot = plot_of(truth, estimate, show_first ? T_first : *T_aligned, figures,
                        show_first ? "first_fixed" : "aligned", options);
  report.figures = std::move(figures);
  report.T_truth_estimate = T_first;
  return report;
}

}  // namespace povslam::scores
