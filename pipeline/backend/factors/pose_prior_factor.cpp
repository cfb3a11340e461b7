#include "pipeline/backend/factors/pose_prior_factor.hpp"

#include "pipeline/backend/factors/pose_jacobian.hpp"
#include "pipeline/backend/factors/vo_transition_factor.hpp"

namespace povslam {

PosePriorError pose_prior_error(const VemPosePrior& prior, const Rigid3& T_world_camera) {
  PosePriorError out{local(prior.T_world_camera, T_world_camera), Matrix6d::Identity()};
  out.by_pose.bottomRightCorner<3, 3>() = so3_left_jacobian_inverse(out.e.tail<3>());
  return out;
}

bool PosePriorFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const PosePriorError error = pose_prior_error(prior_, read_pose(parameters[0]));
  const Vector6d whiten = inverse_sigmas(prior_.sigma_m, prior_.sigma_rad);
  Eigen::Map<Vector6d>{residuals} = whiten.cwiseProduct(error.e);
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    write_pose_jacobian<6>(whiten.asDiagonal() * error.by_pose, parameters[0], jacobians[0]);
  }
  return true;
}

}  // namespace povslam
