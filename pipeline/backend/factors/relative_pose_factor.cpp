#include "pipeline/backend/factors/relative_pose_factor.hpp"

#include "pipeline/backend/factors/pose_manifold.hpp"

namespace povslam {

namespace {

using BlockJacobian = Eigen::Matrix<double, 6, 7, Eigen::RowMajor>;

Rigid3 read(const double* block) {
  return {Eigen::Map<const Eigen::Quaterniond>(block), Eigen::Map<const Eigen::Vector3d>(block + 4)};
}

void write(const Matrix6d& by_tangent, const double* block, double* jacobian) {
  BlockJacobian tangent_by_block;
  PoseManifold().MinusJacobian(block, tangent_by_block.data());
  Eigen::Map<BlockJacobian>{jacobian}.noalias() = by_tangent * tangent_by_block;
}

}  // namespace

Vector6d RelativePose::error(const Rigid3& T_world_from, const Rigid3& T_world_to) const {
  return local(T_from_to, T_world_from.inverse() * T_world_to);
}

Vector6d RelativePose::whitened(const Vector6d& error) const {
  Vector6d r;
  r << error.head<3>() / sigma_m, error.tail<3>() / sigma_rad;
  return r;
}

bool RelativePoseFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Rigid3 from = read(parameters[0]), to = read(parameters[1]);
  const Vector6d error = measured_.error(from, to);
  Eigen::Map<Vector6d>{residuals} = measured_.whitened(error);
  if (jacobians == nullptr) return true;
  const Eigen::Matrix3d R_from_world = from.rotation.conjugate().toRotationMatrix();
  const Eigen::Matrix3d by_p = R_from_world / measured_.sigma_m;
  const Eigen::Matrix3d by_R = so3_left_jacobian_inverse(error.tail<3>()) * R_from_world / measured_.sigma_rad;
  Matrix6d by_to = Matrix6d::Zero();
  by_to.topLeftCorner<3, 3>() = by_p;
  by_to.bottomRightCorner<3, 3>() = by_R;
  if (jacobians[1] != nullptr) write(by_to, parameters[1], jacobians[1]);
  if (jacobians[0] == nullptr) return true;
  Matrix6d by_from = -by_to;  // and a turn of `from` swings what it sees
  by_from.topRightCorner<3, 3>() = by_p * skew(to.translation - from.translation);
  write(by_from, parameters[0], jacobians[0]);
  return true;
}

}  // namespace povslam
