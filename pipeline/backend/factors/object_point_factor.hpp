// A point measured in the camera lies on its landmark (POV-SLAM, the Gaussian mode of eq. 9 and 18):
//   e = T_world_camera d - l, its information the responsibility over the variance; 0: not accepted, no pull.
// The pixels' factor of local bundle adjustment is keypoint_factor.
#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>

namespace povslam {

// Parameter blocks: T_world_camera (7, see PoseManifold) and p_world (3). 3 residuals, whitened.
class ObjectPointFactor final : public ceres::SizedCostFunction<3, 7, 3> {
 public:
  // `information` [1/m^2] is read anew at each evaluation; it must outlive the factor.
  ObjectPointFactor(const Eigen::Vector3d& p_camera, const double* information)
      : p_camera_(p_camera), information_(information) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Eigen::Vector3d p_camera_;
  const double* information_;
};

}  // namespace povslam
