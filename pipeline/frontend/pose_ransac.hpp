// Camera pose from landmarks at known places of which many are wrong: poses from three points with depth (3-D to 3-D),
// judged by all points in pixels and depth; each that is better than those before is polished by the robust pose
// (RANSAC with local optimisation: Chum, Matas and Kittler, DAGM 2003). Bounded work; the same input, the same answer.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pipeline/frontend/solve_pose.hpp"

namespace povslam {

class PoseRansac {
 public:
  PoseRansac(const PinholeCamera& camera, std::size_t max_points);

  // T_camera_world that at least min_agreeing of the points agree with. `fits` of the points is not looked at.
  std::optional<Rigid3> find(std::span<const PoseObservation> points, int min_agreeing);

  // Whether the point's pixel, and its depth if it has one, agree with the pose. wide: as a pose from three points may.
  static bool agrees(const PinholeCamera& camera, const PoseObservation& point, const Eigen::Vector3d& p_camera,
                     bool wide);

 private:
  struct Random;
  std::optional<Rigid3> pose_of_three(std::span<const PoseObservation> points, Random& random) const;
  int count(std::span<const PoseObservation> points, const Rigid3& T_camera_world, bool wide) const;
  Rigid3 polish(std::span<const PoseObservation> points, const Rigid3& T_camera_world);

  PinholeCamera camera_;
  std::vector<std::uint32_t> with_depth_;
  std::vector<PoseObservation> agreeing_;
};

}  // namespace povslam
