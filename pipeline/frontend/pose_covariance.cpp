#include "pipeline/frontend/pose_covariance.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace povslam {

namespace {
constexpr double kIndependentLandmarks = 50.0;
}

Matrix6d covariance_to_landmarks(const PoseSolution& solution) {
  // xi perturbs T_camera_world on the left; the covariance is of the camera's place and turn in the world.
  const double share = std::min(1.0, kIndependentLandmarks / std::max(1, solution.num_inliers));
  const Matrix6d sigma = (share * solution.information + 1e-9 * Matrix6d::Identity()).inverse();
  const Eigen::Matrix3d R = solution.T_camera_world.matrix3().transpose();
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = -R;
  J.bottomRightCorner<3, 3>() = -R;
  return J * sigma * J.transpose();
}

Matrix6d carry_covariance(const Matrix6d& covariance, const Eigen::Vector3d& p_from, const Eigen::Vector3d& p_to) {
  Matrix6d J = Matrix6d::Identity();
  J.topRightCorner<3, 3>() = -skew(p_to - p_from);
  return J * covariance * J.transpose();
}

Matrix6d covariance_of_anchors(Map& map, const Frame& frame, const Rigid3& T_world_camera) {
  for (std::int32_t s = 0; s < map.keyframe_slots(); ++s) map.keyframe(s).votes = 0;
  int total = 0;
  for (int i = 0; i < frame.size(); ++i) {
    const std::int32_t seen = frame.landmark[static_cast<std::size_t>(i)];
    if (seen == kNone) continue;
    ++map.keyframe(map.landmark(seen).anchor).votes;
    ++total;
  }
  Matrix6d sum = Matrix6d::Zero();
  for (std::int32_t s = 0; s < map.keyframe_slots() && total > 0; ++s) {
    const Keyframe& kf = map.keyframe(s);
    if (kf.votes == 0) continue;
    const double share = static_cast<double>(kf.votes) / total;
    sum += share * carry_covariance(kf.covariance, kf.T_world_camera.translation, T_world_camera.translation);
  }
  return sum;
}

}  // namespace povslam
