// A landmark keeps its place in its object (POV-SLAM, eq. 4): e = T_OW l - l^O. Written as T_WO l^O - l, in the world's
// axes: the noise is isotropic, so the norm is the same, and the landmark's Jacobian is -I.
#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>

namespace povslam {

// Parameter blocks: object (position, yaw: 4) and p_world (3). 3 residuals, whitened.
class RigidityFactor final : public ceres::SizedCostFunction<3, 4, 3> {
 public:
  RigidityFactor(const Eigen::Vector3d& p_object, double sigma_m) : p_object_(p_object), whiten_(1.0 / sigma_m) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Eigen::Vector3d p_object_;
  double whiten_;
};

}  // namespace povslam
