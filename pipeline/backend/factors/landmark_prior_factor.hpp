// A landmark stays where the map has it (POV-SLAM, eq. 5): e = l - l_prev.
#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>

namespace povslam {

// Parameter block: p_world (3). 3 residuals, whitened.
class LandmarkPriorFactor final : public ceres::SizedCostFunction<3, 3> {
 public:
  LandmarkPriorFactor(const Eigen::Vector3d& p_prev, double sigma_m) : p_prev_(p_prev), whiten_(1.0 / sigma_m) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Eigen::Vector3d p_prev_;
  double whiten_;
};

}  // namespace povslam
