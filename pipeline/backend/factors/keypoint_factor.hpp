// The pixel of one observation of a landmark, whitened: with p_camera = T_world_camera^-1 p_world = (x, y, z),
//   r = [ (fx x/z + cx - u) / sigma_px, (fy y/z + cy - v) / sigma_px ].
// Its depth is a factor of its own (DepthFactor).
// A point nearer than kMinDepthM to the image plane, or behind it, gives a large constant residual that pulls nowhere:
// always finite, dear enough that no step goes there.
#pragma once

#include <ceres/cost_function.h>

#include "pipeline/geometry/rigid.hpp"

namespace povslam {

struct KeypointObservation {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  // px
  double u_px = 0.0, v_px = 0.0;                  // rectified
  double sigma_px = 1.0;

  // At p_camera; needs z > 0.
  Eigen::Vector2d residual(const Eigen::Vector3d& p_camera) const;
  Eigen::Matrix<double, 2, 3> derivative(const Eigen::Vector3d& p_camera) const;  // by p_camera
};

// Parameter blocks: pose (7, see PoseManifold) and p_world (3).
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
