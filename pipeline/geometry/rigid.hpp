// Rigid motions SE(3).
//
// T_a_b maps points from frame b to frame a: p_a = T_a_b * p_b. Adjacent frames touch: T_a_c = T_a_b * T_b_c.
// Tangent vectors are xi = (rho, phi): translation [m] first, rotation [rad] second.
// Stated once, used everywhere:
//   exp/log        the group's own: T = Exp(xi), coupled through the left Jacobian.
//   retract        how optimisers and covariances perturb a pose: on the left (in the axes of frame a), about
//                  the pose's own origin:  p <- p + rho,  R <- Exp(phi) R.   local is its inverse.
// A 6x6 covariance of T_a_b is that of retract's xi: (x, y, z, rot_x, rot_y, rot_z) in the axes of a.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace povslam {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

struct Rigid3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // unit
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();         // metres

  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return rotation * p + translation; }
  Rigid3 operator*(const Rigid3& other) const {
    return {(rotation * other.rotation).normalized(), rotation * other.translation + translation};
  }
  Rigid3 inverse() const {
    const Eigen::Quaterniond back = rotation.conjugate();
    return {back, -(back * translation)};
  }
  Eigen::Matrix3d matrix3() const { return rotation.toRotationMatrix(); }
};

Eigen::Matrix3d skew(const Eigen::Vector3d& v);  // skew(a) b = a x b

Eigen::Quaterniond so3_exp(const Eigen::Vector3d& phi);
Eigen::Vector3d so3_log(const Eigen::Quaterniond& q);  // |phi| <= pi; at pi either of the two opposite axes
Eigen::Matrix3d so3_left_jacobian(const Eigen::Vector3d& phi);
Eigen::Matrix3d so3_left_jacobian_inverse(const Eigen::Vector3d& phi);

Rigid3 se3_exp(const Vector6d& xi);
Vector6d se3_log(const Rigid3& T);
Matrix6d adjoint(const Rigid3& T);  // T Exp(xi) T^-1 = Exp(adjoint(T) xi)

Rigid3 retract(const Rigid3& T, const Vector6d& xi);
Vector6d local(const Rigid3& T, const Rigid3& other);  // retract(T, local(T, other)) = other

// Motion of constant velocity as seen from the moving frame (a screw): s = 0 gives a, s = 1 gives b, s outside [0, 1]
// extrapolates.
Rigid3 interpolate(const Rigid3& a, const Rigid3& b, double s);

double rotation_angle_rad(const Rigid3& T);

}  // namespace povslam
