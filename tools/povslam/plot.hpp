// The trajectory plot: path from above (equal axes, metric grid), errors over time, and the figures as text.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/replay/trajectory_file.hpp"
#include "pipeline/base/result.hpp"

namespace povslam {

struct PlottedTrajectory {
  std::string name;                // in the legend
  std::vector<StampedPose> poses;  // T_world_camera in the truth's world (aligned as wanted), by stamp
};

struct TrajectoryPlot {
  std::string title;
  std::vector<StampedPose> truth;            // may be empty: height and yaw are shown instead of errors
  std::vector<PlottedTrajectory> estimates;  // at most six
  std::vector<std::string> notes;            // lines of the text block; "name: value" is set in two columns
  std::optional<TimeNs> lap1_end;            // drawn as a mark in time
  double max_gap_s = 0.1;                    // longest hole in the truth that errors are interpolated over
};

// Writes .png or .svg by the file's ending; any other name gets both, NAME.png and NAME.svg.
// The view is from above (x-y) when the cameras' up is on average within 60 degrees of world z; a world of any other
// attitude is projected on the two principal axes of the path.
Status plot_trajectories(const std::string& file, const TrajectoryPlot& data);

}  // namespace povslam
