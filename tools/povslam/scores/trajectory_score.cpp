#include "tools/povslam/scores/trajectory_score.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/geometry/align.hpp"

namespace povslam::scores {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

double rmse(const std::vector<double>& errors) {
  double sum = 0.0;
  for (const double error : errors) sum += error * error;
  return errors.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(errors.size()));
}

double median(std::vector<double> errors) {
  if (errors.empty()) return 0.0;
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  if (errors.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(errors.begin(), middle));
}

Eigen::Vector3d mean_truth(std::span<const ScoredPose> poses) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ScoredPose& pose : poses) sum += pose.T_world_truth.translation;
  return sum / static_cast<double>(poses.size());
}

// Index of the pose nearest to `stamp`; poses are by stamp and not empty.
std::size_t nearest(std::span<const ScoredPose> poses, TimeNs stamp) {
  const auto after = std::lower_bound(poses.begin(), poses.end(), stamp,
                                      [](const ScoredPose& pose, TimeNs value) { return pose.stamp < value; });
  if (after == poses.begin()) return 0;
  const auto before = after - 1;
  const bool take_before = after == poses.end() || stamp - before->stamp <= after->stamp - stamp;
  return static_cast<std::size_t>((take_before ? before : after) - poses.begin());
}

}  // namespace

Rigid3 fix_first_pose(std::span<const ScoredPose> poses) {
  EXPECTS(!poses.empty());
  return poses.front().T_world_truth * poses.front().T_world_estimate.inverse();
}

std::optional<Rigid3> align_positions(std::span<const ScoredPose> poses) {
  std::vector<Eigen::Vector3d> truth, estimate;
  for (const ScoredPose& pose : poses) {
    truth.push_back(pose.T_world_truth.translation);
    estimate.push_back(pose.T_world_estimate.translation);
  }
  // A straight run leaves the roll about it open, which does not change a distance.
  return align_points(truth, estimate, true);
}

Rigid3 align_rotations(std::span<const ScoredPose> poses) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const ScoredPose& pose : poses)
    sum += pose.T_world_truth.matrix3() * pose.T_world_estimate.matrix3().transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d flip(1.0, 1.0, 1.0);
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) flip.z() = -1.0;
  const Eigen::Matrix3d R = svd.matrixU() * flip.asDiagonal() * svd.matrixV().transpose();
  return {Eigen::Quaterniond(R).normalized(), Eigen::Vector3d::Zero()};
}

PoseErrors pose_errors(std::span<const ScoredPose> poses, const Rigid3& T_truth_estimate) {
  std::vector<double> distances_m, angles_deg;
  for (const ScoredPose& pose : poses) {
    const Rigid3 T_estimate = T_truth_estimate * pose.T_world_estimate;
    distances_m.push_back((T_estimate.translation - pose.T_world_truth.translation).norm());
    angles_deg.push_back(rotation_angle_rad(pose.T_world_truth.inverse() * T_estimate) * kDegPerRad);
  }
  PoseErrors errors;
  errors.poses = poses.size();
  if (poses.empty()) return errors;
  errors.rmse_m = rmse(distances_m);
  for (const double distance_m : distances_m) errors.mean_m += distance_m / static_cast<double>(poses.size());
  errors.median_m = median(distances_m);
  errors.max_m = *std::max_element(distances_m.begin(), distances_m.end());
  errors.rotation_rmse_deg = rmse(angles_deg);
  return errors;
}

StandstillErrors standstill_errors(std::span<const ScoredPose> poses) {
  if (poses.empty()) return {};
  const Eigen::Vector3d mean = mean_truth(poses);
  std::vector<double> from_first, from_mean;
  for (const ScoredPose& pose : poses) {
    from_first.push_back((pose.T_world_truth.translation - poses.front().T_world_truth.translation).norm());
    from_mean.push_back((pose.T_world_truth.translation - mean).norm());
  }
  return {rmse(from_first), rmse(from_mean)};
}

RelativeErrors relative_errors(std::span<const ScoredPose> poses, double window_s) {
  const TimeNs window = from_seconds(window_s);
  std::vector<double> translations_m, rotations_deg;
  constexpr TimeNs kRounding = 2 * kNsPerMs;  // of stamps kept as text
  for (const ScoredPose& from : poses) {
    if (from.stamp + window > poses.back().stamp + kRounding) break;
    const ScoredPose& to = poses[nearest(poses, from.stamp + window)];
    if (std::abs(to.stamp - from.stamp - window) > window / 10) continue;
    const Rigid3 truth = from.T_world_truth.inverse() * to.T_world_truth;
    const Rigid3 error = truth.inverse() * (from.T_world_estimate.inverse() * to.T_world_estimate);
    translations_m.push_back(error.translation.norm());
    rotations_deg.push_back(rotation_angle_rad(error) * kDegPerRad);
  }
  return {rmse(translations_m), rmse(rotations_deg), translations_m.size()};
}

}  // namespace povslam::scores
