#include "pipeline/geometry/rigid.hpp"

#include <cmath>

namespace povslam {

namespace {

constexpr double kSmallAngleRad = 1e-5;

// Coefficients of the left Jacobian I + a W + b W^2, without the cancellation of their textbook forms.
double one_minus_cos_over_square(double angle) {
  if (angle < kSmallAngleRad) return 0.5;
  const double sinc_half = std::sin(0.5 * angle) / (0.5 * angle);
  return 0.5 * sinc_half * sinc_half;
}
double angle_minus_sin_over_cube(double angle) {
  const double x = angle * angle;
  if (angle < 0.1) return (1.0 - x / 20.0 * (1.0 - x / 42.0 * (1.0 - x / 72.0))) / 6.0;
  return (angle - std::sin(angle)) / (x * angle);
}
// Coefficient c of the inverse I - W / 2 + c W^2; singular at 2 pi.
double inverse_coefficient(double angle) {
  const double x = angle * angle;
  if (angle < 0.1) return (1.0 + x / 60.0 * (1.0 + x / 42.0 * (1.0 + x / 40.0))) / 12.0;
  return 1.0 / x - 0.5 / (angle * std::tan(0.5 * angle));
}

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

Eigen::Quaterniond so3_exp(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const double half = 0.5 * angle;
  const double sine_over_angle = angle < kSmallAngleRad ? 0.5 - angle * angle / 48.0 : std::sin(half) / angle;
  Eigen::Quaterniond q;
  q.w() = std::cos(half);
  q.vec() = sine_over_angle * phi;
  return q.normalized();
}

Eigen::Vector3d so3_log(const Eigen::Quaterniond& q) {
  const Eigen::Quaterniond p = q.w() < 0.0 ? Eigen::Quaterniond(-q.coeffs()) : q;  // the short way round
  const double sine = p.vec().norm();
  const double angle = 2.0 * std::atan2(sine, p.w());
  return sine < kSmallAngleRad ? Eigen::Vector3d(2.0 * p.vec()) : Eigen::Vector3d(angle / sine * p.vec());
}

Eigen::Matrix3d so3_left_jacobian(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const Eigen::Matrix3d W = skew(phi);
  return Eigen::Matrix3d::Identity() + one_minus_cos_over_square(angle) * W + angle_minus_sin_over_cube(angle) * W * W;
}

Eigen::Matrix3d so3_left_jacobian_inverse(const Eigen::Vector3d& phi) {
  const Eigen::Matrix3d W = skew(phi);
  return Eigen::Matrix3d::Identity() - 0.5 * W + inverse_coefficient(phi.norm()) * W * W;
}

Rigid3 se3_exp(const Vector6d& xi) {
  const Eigen::Vector3d phi = xi.tail<3>();
  return {so3_exp(phi), so3_left_jacobian(phi) * xi.head<3>()};
}

Vector6d se3_log(const Rigid3& T) {
  const Eigen::Vector3d phi = so3_log(T.rotation);
  Vector6d xi;
  xi << so3_left_jacobian_inverse(phi) * T.translation, phi;
  return xi;
}

Matrix6d adjoint(const Rigid3& T) {
  const Eigen::Matrix3d R = T.matrix3();
  Matrix6d ad = Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = R;
  ad.bottomRightCorner<3, 3>() = R;
  ad.topRightCorner<3, 3>() = skew(T.translation) * R;
  return ad;
}

Rigid3 retract(const Rigid3& T, const Vector6d& xi) {
  return {(so3_exp(xi.tail<3>()) * T.rotation).normalized(), T.translation + xi.head<3>()};
}

Vector6d local(const Rigid3& T, const Rigid3& other) {
  Vector6d xi;
  xi << other.translation - T.translation, so3_log(other.rotation * T.rotation.conjugate());
  return xi;
}

Rigid3 interpolate(const Rigid3& a, const Rigid3& b, double s) {
  return a * se3_exp(s * se3_log(a.inverse() * b));
}

double rotation_angle_rad(const Rigid3& T) {
  return so3_log(T.rotation).norm();
}

}  // namespace povslam
