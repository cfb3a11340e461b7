// All figures of one trajectory as JSON (units in the key names), and its plot.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/povslam/plot.hpp"
#include "tools/povslam/scores/trajectory_score.hpp"

namespace povslam::scores {

enum class Alignment : std::uint8_t { first, se3, both };  // which figures are printed; the plot takes `first` for both

struct TrajectoryReportOptions {
  Alignment alignment = Alignment::both;
  double max_gap_s = 0.1;
  double rpe_window_s = 1.0;
  std::optional<TimeNs> lap1_end;  // laps are scored apart, both in the alignment of the whole run
};

struct TrajectoryReport {
  nlohmann::ordered_json figures;
  TrajectoryPlot plot;
  Rigid3 T_truth_estimate;  // first pose fixed
};

// frames: as for match_trajectories. An estimate without any pose that has truth is an error.
Result<TrajectoryReport> report_trajectory(const std::vector<StampedPose>& truth,
                                           const std::vector<StampedPose>& estimate, const std::vector<TimeNs>& frames,
                                           const TrajectoryReportOptions& options);

}  // namespace povslam::scores
