#include "pipeline/backend/factors/object_point_factor.hpp"

#include <cmath>

#include "pipeline/backend/factors/pose_jacobian.hpp"

namespace povslam {

bool ObjectPointFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const double whiten = std::sqrt(*information_);
  const Rigid3 T_world_camera = read_pose(parameters[0]);
  const Eigen::Vector3d arm = T_world_camera.rotation * p_camera_;
  Eigen::Map<Eigen::Vector3d>{residuals} =
      whiten * (arm + T_world_camera.translation - Eigen::Map<const Eigen::Vector3d>(parameters[1]));
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) {
    Eigen::Matrix<double, 3, 6> by_tangent;
    by_tangent << whiten * Eigen::Matrix3d::Identity(), -whiten * skew(arm);
    write_pose_jacobian<3>(by_tangent, parameters[0], jacobians[0]);
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{jacobians[1]} = -whiten * Eigen::Matrix3d::Identity();
  }
  return true;
}

}  // namespace povslam
