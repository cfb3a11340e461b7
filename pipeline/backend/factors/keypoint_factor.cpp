#include "pipeline/backend/factors/keypoint_factor.hpp"

#include <algorithm>

namespace povslam {

namespace {

using Map3 = Eigen::Map<const Eigen::Vector3d>;

// d (R(q)^T d) / d (qx qy qz qw), where R(q)^T d = d - 2 w (v x d) + 2 v x (v x d) for q = (v, w).
Eigen::Matrix<double, 3, 4> unrotate_derivative(const Eigen::Vector3d& v, double w, const Eigen::Vector3d& d) {
  Eigen::Matrix<double, 3, 4> J;
  J.leftCols<3>() = 2.0 * (w * skew(d) + v * d.transpose() - 2.0 * d * v.transpose());
  J.leftCols<3>().diagonal().array() += 2.0 * v.dot(d);
  J.col(3) = -2.0 * v.cross(d);
  return J;
}

}  // namespace

Eigen::Vector2d KeypointObservation::residual(const Eigen::Vector3d& p_camera) const {
  const double inverse_z = 1.0 / p_camera.z();
  return {(fx * p_camera.x() * inverse_z + cx - u_px) / sigma_px,
          (fy * p_camera.y() * inverse_z + cy - v_px) / sigma_px};
}

Eigen::Matrix<double, 2, 3> KeypointObservation::derivative(const Eigen::Vector3d& p_camera) const {
  const double inverse_z = 1.0 / p_camera.z();
  const double a = fx * inverse_z / sigma_px;
  const double b = fy * inverse_z / sigma_px;
  Eigen::Matrix<double, 2, 3> J;
  J << a, 0.0, -a * p_camera.x() * inverse_z, 0.0, b, -b * p_camera.y() * inverse_z;
  return J;
}

KeypointFactor::KeypointFactor(const KeypointObservation& seen) : seen_(seen) {
  set_num_residuals(2);
  *mutable_parameter_block_sizes() = {7, 3};
}

bool KeypointFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const double* pose = parameters[0];
  const Eigen::Matrix3d R_camera_world = Eigen::Map<const Eigen::Quaterniond>(pose).conjugate().toRotationMatrix();
  const Eigen::Vector3d offset_world = Map3(parameters[1]) - Map3(pose + 4);
  const Eigen::Vector3d p_camera = R_camera_world * offset_world;
  if (!(p_camera.z() > kMinDepthM)) {
    std::fill_n(residuals, 2, kBehindResidual);
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) std::fill_n(jacobians[0], 14, 0.0);
    if (jacobians[1] != nullptr) std::fill_n(jacobians[1], 6, 0.0);
    return true;
  }
  Eigen::Map<Eigen::Vector2d>{residuals} = seen_.residual(p_camera);
  if (jacobians == nullptr) return true;
  const Eigen::Matrix<double, 2, 3> outer = seen_.derivative(p_camera);
  const Eigen::Matrix<double, 2, 3> by_point = outer * R_camera_world;
  if (jacobians[1] != nullptr) Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>{jacobians[1]} = by_point;
  if (jacobians[0] == nullptr) return true;
  Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> by_pose(jacobians[0]);
  by_pose.leftCols<4>() = outer * unrotate_derivative(Map3(pose), pose[3], offset_world);
  by_pose.rightCols<3>() = -by_point;
  return true;
}

}  // namespace povslam
