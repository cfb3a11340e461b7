// A local bundle adjustment as plain values: what the frontend asks, what the backend answers.
// Filled on the tracking thread within capacities reserved once, solved in place beside it, handed back.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/geometry/rigid.hpp"

namespace povslam {

struct SmoothProblem {
  struct Pose {
    Rigid3 T_world_camera;
    std::int64_t keyframe = -1;  // id of the keyframe
    bool fixed = false;
  };
  struct Point {
    Eigen::Vector3d p_world = Eigen::Vector3d::Zero();
    std::int32_t landmark = -1;    // slot in the map
    std::uint32_t generation = 0;  // of the slot: an answer for a landmark that was replaced meanwhile is ignored
  };
  struct Observation {
    std::int32_t pose = 0, point = 0;  // indices into the arrays here
    float u_px = 0.0F, v_px = 0.0F;    // rectified pixel
    float inverse_depth_per_m = 0.0F;  // 1/z measured; 0 = none
    float sigma_px = 1.0F;
    float sigma_inverse_depth_per_m = 1.0F;
    bool outlier = false;  // answer: does not fit after smoothing
  };

  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  // px
  std::vector<Pose> poses;
  std::vector<Point> points;
  std::vector<Observation> observations;
  std::int64_t asked_at_frame = 0;

  // Answer.
  bool converged = false;
  int iterations = 0;
  double cost_before = 0.0, cost_after = 0.0;  // 1/2 sum of robust squared whitened residuals

  void clear() {
    poses.clear();
    points.clear();
    observations.clear();
    converged = false;
    iterations = 0;
    cost_before = cost_after = 0.0;
  }
};

}  // namespace povslam
