// One RGB-D observation of a landmark, whitened: with p_camera = T_world_camera^-1 p_world = (x, y, z),
//   r = [ (fx x/z + cx - u) / sigma_px, (fy y/z + cy - v) / sigma_px, (1/z - inverse_depth) / sigma_inverse_depth ]
// or only its first two rows where no depth was measured.
// A point nearer than kMinDepthM to the image plane, or behind it, gives a large constant residual that pulls nowhere:
// always finite, dear enough that no step goes there.
#pragma once

#include <ceres/cost_function.h>

#include "pipeline/geometry/rigid.hpp"

namespace povslam {

struct KeypointObservation {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  // px
  double u_px = 0.0, v_px = 0.0;                  // rectified pixel
  double inverse_depth_per_m = 0.0;               // 1/z measured; 0 = none
  double sigma_px = 1.0;
  double sigma_inverse_depth_per_m = 1.0;

  bool has_depth() const { return inverse_depth_per_m > 0.0; }
  // The residual at p_camera; its third entry is 0 without depth.
  Eigen::Vector3d residual(const Eigen::Vector3d& p_camera) const;
  // d residual / d p_camera; needs z > 0.
  Eigen::Matrix3d derivative(const Eigen::Vector3d& p_camera) const;
};

// Parameter blocks: pose (7, see PoseManifold) and p_world (3). 3 residuals, or 2 without depth.
class KeypointFactor final : public ceres::CostFunction {
 public:
  static constexpr double kMinDepthM = 0.05;
  static constexpr double kBehindResidual = 100.0;

  explicit KeypointFactor(const KeypointObservation& seen);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  KeypointObservation seen_;
};

}  // namespace povslam
