#include "pipeline/backend/factors/pose_manifold.hpp"

#include <algorithm>

namespace povslam {

namespace {

using Map3 = Eigen::Map<const Eigen::Vector3d>;
using MapQ = Eigen::Map<const Eigen::Quaterniond>;

Rigid3 read(const double* block) {
  return {MapQ(block), Map3(block + 4)};
}

void write(const Rigid3& T, double* block) {
  Eigen::Map<Eigen::Vector4d>{block} = T.rotation.coeffs();
  Eigen::Map<Eigen::Vector3d>{block + 4} = T.translation;
}

// d(qx qy qz qw)/d phi of Exp(phi) q at phi = 0; its transpose times 4 is the inverse map.
Eigen::Matrix<double, 4, 3> quaternion_from_tangent(const double* block) {
  const Map3 v(block);
  Eigen::Matrix<double, 4, 3> d;
  d.topRows<3>() = 0.5 * (block[3] * Eigen::Matrix3d::Identity() - skew(v));
  d.bottomRows<1>() = -0.5 * v.transpose();
  return d;
}

}  // namespace

PoseBlock to_block(const Rigid3& T) {
  PoseBlock block;
  write(T, block.data());
  return block;
}

Rigid3 from_block(const PoseBlock& block) {
  Rigid3 T = read(block.data());
  T.rotation.normalize();
  return T;
}

bool PoseManifold::Plus(const double* pose, const double* xi, double* moved) const {
  write(retract(read(pose), Eigen::Map<const Vector6d>(xi)), moved);
  return true;
}

bool PoseManifold::PlusJacobian(const double* pose, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>> J(jacobian);
  J.setZero();
  J.topRightCorner<4, 3>() = quaternion_from_tangent(pose);
  J.bottomLeftCorner<3, 3>().setIdentity();
  return true;
}

bool PoseManifold::Minus(const double* other, const double* pose, double* xi) const {
  Eigen::Map<Vector6d>{xi} = local(read(pose), read(other));
  return true;
}

bool PoseManifold::MinusJacobian(const double* pose, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> J(jacobian);
  J.setZero();
  J.bottomLeftCorner<3, 4>() = 4.0 * quaternion_from_tangent(pose).transpose();
  J.topRightCorner<3, 3>().setIdentity();
  return true;
}

}  // namespace povslam
