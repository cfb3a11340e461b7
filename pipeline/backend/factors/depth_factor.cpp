#include "pipeline/backend/factors/depth_factor.hpp"

#include <algorithm>

#include "pipeline/backend/factors/keypoint_factor.hpp"
#include "pipeline/geometry/rigid.hpp"

namespace povslam {

DepthFactor::DepthFactor(double inverse_depth_per_m, double sigma_inverse_depth_per_m)
    : inverse_depth_per_m_(inverse_depth_per_m), sigma_per_m_(sigma_inverse_depth_per_m) {
  set_num_residuals(1);
  *mutable_parameter_block_sizes() = {7, 3};
}

// z = d . c with d = p_world - t and c the camera's axis in the world, the third column of R(q):
// c = (2 (x z + w y), 2 (y z - w x), 1 - 2 (x^2 + y^2)).
bool DepthFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const double* pose = parameters[0];
  const double x = pose[0], y = pose[1], z = pose[2], w = pose[3];
  const Eigen::Vector3d axis(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y));
  const Eigen::Vector3d d(parameters[1][0] - pose[4], parameters[1][1] - pose[5], parameters[1][2] - pose[6]);
  const double depth = d.dot(axis);
  if (!(depth > KeypointFactor::kMinDepthM)) {
    residuals[0] = KeypointFactor::kBehindResidual;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) std::fill_n(jacobians[0], 7, 0.0);
    if (jacobians[1] != nullptr) std::fill_n(jacobians[1], 3, 0.0);
    return true;
  }
  residuals[0] = (1.0 / depth - inverse_depth_per_m_) / sigma_per_m_;
  if (jacobians == nullptr) return true;
  const double by_depth = -1.0 / (depth * depth * sigma_per_m_);
  const Eigen::Vector3d by_point = by_depth * axis;
  if (jacobians[1] != nullptr) std::copy_n(by_point.data(), 3, jacobians[1]);
  if (jacobians[0] == nullptr) return true;
  Eigen::Map<Eigen::Matrix<double, 1, 7>> by_pose(jacobians[0]);
  by_pose.head<4>() << 2.0 * (z * d.x() - w * d.y() - 2.0 * x * d.z()), 2.0 * (w * d.x() + z * d.y() - 2.0 * y * d.z()),
      2.0 * (x * d.x() + y * d.y()), 2.0 * (y * d.x() - x * d.y());
  by_pose.head<4>() *= by_depth;
  by_pose.tail<3>() = -by_point.transpose();
  return true;
}

}  // namespace povslam
