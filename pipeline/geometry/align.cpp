#include "pipeline/geometry/align.hpp"

#include <Eigen/SVD>

#include "pipeline/base/expects.hpp"

namespace povslam {

std::optional<Rigid3> align_points(std::span<const Eigen::Vector3d> points_a, std::span<const Eigen::Vector3d> points_b,
                                   bool allow_degenerate) {
  EXPECTS(points_a.size() == points_b.size());
  if (points_a.size() < 3) return std::nullopt;
  const auto count = static_cast<double>(points_a.size());
  Eigen::Vector3d mean_a = Eigen::Vector3d::Zero(), mean_b = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < points_a.size(); ++i) {
    mean_a += points_a[i];
    mean_b += points_b[i];
  }
  mean_a /= count;
  mean_b /= count;
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < points_a.size(); ++i) {
    cross += (points_a[i] - mean_a) * (points_b[i] - mean_b).transpose();
  }
  if (!cross.allFinite()) return std::nullopt;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& s = svd.singularValues();
  if (!allow_degenerate && !(s(1) > 1e-9 * s(0))) return std::nullopt;
  Eigen::Vector3d flip(1.0, 1.0, 1.0);
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) flip.z() = -1.0;
  const Eigen::Matrix3d R = svd.matrixU() * flip.asDiagonal() * svd.matrixV().transpose();
  Rigid3 T;
  T.rotation = Eigen::Quaterniond(R).normalized();
  T.translation = mean_a - R * mean_b;
  return T;
}

}  // namespace povslam
