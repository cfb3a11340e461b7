// The depth of one observation of a landmark, whitened: r = (1/z - inverse_depth) / sigma_inverse_depth, z the depth of
// p_camera = T_world_camera^-1 p_world. Apart from its pixel (KeypointFactor), since a corner on an edge often has a
// good pixel and a wrong depth.
#pragma once

#include <ceres/cost_function.h>

namespace povslam {

// Parameter blocks: pose (7, see PoseManifold) and p_world (3). Nearer than KeypointFactor::kMinDepthM to the image
// plane, or behind it: KeypointFactor::kBehindResidual, which pulls nowhere.
class DepthFactor final : public ceres::CostFunction {
 public:
  // inverse_depth_per_m: 1/z measured. sigma_inverse_depth_per_m > 0.
  DepthFactor(double inverse_depth_per_m, double sigma_inverse_depth_per_m);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  double inverse_depth_per_m_;
  double sigma_per_m_;
};

}  // namespace povslam
