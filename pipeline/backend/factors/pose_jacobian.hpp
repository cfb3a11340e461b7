// A Jacobian along the manifold of poses, told in the seven numbers of a block; across the manifold it is zero.
#pragma once

#include "pipeline/backend/factors/pose_manifold.hpp"

namespace povslam {

template <int kRows>
void write_pose_jacobian(const Eigen::Matrix<double, kRows, 6>& by_tangent, const double* block, double* jacobian) {
  Eigen::Matrix<double, 6, 7, Eigen::RowMajor> tangent_by_block;
  PoseManifold().MinusJacobian(block, tangent_by_block.data());
  Eigen::Map<Eigen::Matrix<double, kRows, 7, Eigen::RowMajor>>{jacobian}.noalias() = by_tangent * tangent_by_block;
}

inline Rigid3 read_pose(const double* block) {
  return {Eigen::Map<const Eigen::Quaterniond>(block), Eigen::Map<const Eigen::Vector3d>(block + 4)};
}

}  // namespace povslam
