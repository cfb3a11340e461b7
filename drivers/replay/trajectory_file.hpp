// Trajectories as the TUM RGB-D benchmark keeps them: lines "t tx ty tz qx qy qz qw" (s, m, unit quaternion).
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/base/result.hpp"
#include "pipeline/base/time.hpp"
#include "pipeline/geometry/rigid.hpp"

namespace povslam {

struct StampedPose {
  TimeNs stamp = 0;
  Rigid3 T_world_sensor;
};

// Poses with strictly increasing stamps. Lines out of order are sorted and of equal stamps the first is kept, with one
// warning in the log. A line that is no pose (not eight finite numbers, a quaternion far from unit length) or a file
// without any pose is an error that names file and line.
Result<std::vector<StampedPose>> read_trajectory(const std::filesystem::path& path);

// Stamps exact to the nanosecond, poses to 9 digits after the point: the same poses give the same bytes.
Status write_trajectory(const std::filesystem::path& path, std::span<const StampedPose> poses);

// Pose at a stamp, between its two neighbours (straight line, slerp). Nothing outside the trajectory, and nothing where
// the neighbours are more than max_gap_s apart. Stamps must strictly increase.
std::optional<Rigid3> pose_at(std::span<const StampedPose> poses, TimeNs stamp, double max_gap_s);

}  // namespace povslam
