#include "pipeline/backend/factors/vo_transition_factor.hpp"

#include "pipeline/backend/factors/pose_jacobian.hpp"

namespace povslam {

VoTransitionError vo_transition_error(const VemTransition& Z, const Rigid3& A, const Rigid3& B) {
  const Eigen::Matrix3d R_after_world = B.rotation.conjugate().toRotationMatrix();
  const Eigen::Vector3d turned = A.rotation * Z.T_before_after.translation;
  const Eigen::Vector3d offset = turned + A.translation - B.translation;  // world
  VoTransitionError out;
  const Eigen::Vector3d phi = so3_log((B.rotation.conjugate() * A.rotation * Z.T_before_after.rotation).normalized());
  out.e << R_after_world * offset, phi;
  const Eigen::Matrix3d turn = so3_left_jacobian_inverse(phi) * R_after_world;
  out.by_before.setZero();
  out.by_before.topLeftCorner<3, 3>() = R_after_world;
  out.by_before.topRightCorner<3, 3>() = -R_after_world * skew(turned);
  out.by_before.bottomRightCorner<3, 3>() = turn;
  out.by_after = -out.by_before;
  out.by_after.topRightCorner<3, 3>() = R_after_world * skew(offset);
  return out;
}

Vector6d inverse_sigmas(double sigma_m, double sigma_rad) {
  Vector6d out;
  out << Eigen::Vector3d::Constant(1.0 / sigma_m), Eigen::Vector3d::Constant(1.0 / sigma_rad);
  return out;
}

bool VoTransitionFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const VoTransitionError error = vo_transition_error(Z_, read_pose(parameters[0]), read_pose(parameters[1]));
  const Vector6d whiten = inverse_sigmas(Z_.sigma_m, Z_.sigma_rad);
  Eigen::Map<Vector6d>{residuals} = whiten.cwiseProduct(error.e);
  if (jacobians == nullptr) return true;
  const Matrix6d by_before = whiten.asDiagonal() * error.by_before, by_after = whiten.asDiagonal() * error.by_after;
  if (jacobians[0] != nullptr) write_pose_jacobian<6>(by_before, parameters[0], jacobians[0]);
  if (jacobians[1] != nullptr) write_pose_jacobian<6>(by_after, parameters[1], jacobians[1]);
  return true;
}

}  // namespace povslam
