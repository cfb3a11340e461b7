#include "pipeline/backend/moment_blocks.hpp"

namespace povslam {

double total(const Quad& quad) {
  return (quad.lane[0] + quad.lane[1]) + (quad.lane[2] + quad.lane[3]);
}

Moments4 total4(const Quad* quads) {
  Moments4 m;
  for (Eigen::Index i = 0; i < 16; ++i) m.data()[i] = total(quads[i]);
  return m;
}

Matrix6d pose_pose(const Moments4& m, const Eigen::Matrix3d& R_t, const Eigen::Matrix3d& R_s) {
  const Eigen::Vector3d a_t = R_t * m.bottomLeftCorner<3, 1>(), a_s = R_s * m.topRightCorner<1, 3>().transpose();
  const Eigen::Matrix3d both = R_t * m.bottomRightCorner<3, 3>() * R_s.transpose();
  Matrix6d H;
  H.topLeftCorner<3, 3>() = m(0, 0) * Eigen::Matrix3d::Identity();
  H.topRightCorner<3, 3>() = -skew(a_s);
  H.bottomLeftCorner<3, 3>() = skew(a_t);
  H.bottomRightCorner<3, 3>() = both.trace() * Eigen::Matrix3d::Identity() - both.transpose();
  return H;
}

Block64 pose_object(const Moments43& m, const Eigen::Matrix3d& R_t, const Eigen::Rotation2Dd& R_o) {
  const Eigen::Vector2d q = R_o * Eigen::Vector2d(m(0, 1), m(0, 2));
  const Eigen::Matrix<double, 3, 2> both = R_t * m.bottomRightCorner<3, 2>() * R_o.toRotationMatrix().transpose();
  Block64 H = Block64::Zero();
  H.topLeftCorner<3, 3>() = m(0, 0) * Eigen::Matrix3d::Identity();
  H.topRightCorner<3, 1>() << -q.y(), q.x(), 0.0;
  H.bottomLeftCorner<3, 3>() = skew(R_t * m.bottomLeftCorner<3, 1>());
  H.bottomRightCorner<3, 1>() << -both(2, 0), -both(2, 1), both(0, 0) + both(1, 1);
  return H;
}

Eigen::Matrix4d object_object(const double* m, const Eigen::Rotation2Dd& R_o) {
  const Eigen::Vector2d q = R_o * Eigen::Vector2d(m[1], m[2]);
  Eigen::Matrix4d H = m[0] * Eigen::Matrix4d::Identity();
  H(0, 3) = H(3, 0) = -q.y();
  H(1, 3) = H(3, 1) = q.x();
  H(3, 3) = m[3];
  return H;
}

}  // namespace povslam
