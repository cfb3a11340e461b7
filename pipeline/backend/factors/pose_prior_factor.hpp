// Holds the oldest pose of the window where it was last estimated: the "robot prior factor" of the paper's figure 3,
// which its equations leave out. e = local(T_prior, T) = [ p - p_prior ; Log(R R_prior^T) ].
#pragma once

#include <ceres/sized_cost_function.h>

#include "pipeline/backend/window.hpp"

namespace povslam {

struct PosePriorError {
  Vector6d e;        // m, rad
  Matrix6d by_pose;  // by Rigid3's retract
};
PosePriorError pose_prior_error(const VemPosePrior& prior, const Rigid3& T_world_camera);

// Parameter block: T_world_camera (7, see PoseManifold). 6 residuals, whitened.
class PosePriorFactor final : public ceres::SizedCostFunction<6, 7> {
 public:
  explicit PosePriorFactor(const VemPosePrior& prior) : prior_(prior) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  VemPosePrior prior_;
};

}  // namespace povslam
