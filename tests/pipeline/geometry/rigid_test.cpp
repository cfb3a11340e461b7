#include "pipeline/geometry/rigid.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/support/random_geometry.hpp"

namespace povslam {
namespace {

using testing::difference;
using testing::random_axis;
using testing::random_in;
using testing::random_rigid;
using testing::random_rotation_vector;
using testing::random_tangent;
using testing::random_vector;

// Column i: how so3_log(Exp(phi + h e_i) Exp(phi)^-1) grows with h, by central differences.
Eigen::Matrix3d left_jacobian_by_differences(const Eigen::Vector3d& phi) {
  constexpr double kStep = 1e-6;
  Eigen::Matrix3d J;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d h = kStep * Eigen::Vector3d::Unit(i);
    J.col(i) = so3_log(so3_exp(phi + h) * so3_exp(phi - h).conjugate()) / (2.0 * kStep);
  }
  return J;
}

}  // namespace

TEST(Rigid3, MapsPointsFromTheRightFrameToTheLeftOne) {
  const Rigid3 T_world_body{so3_exp({0.0, 0.0, std::numbers::pi / 2}), {1.0, 2.0, 3.0}};  // a quarter turn left
  EXPECT_LT((T_world_body * Eigen::Vector3d(1.0, 0.0, 0.0) - Eigen::Vector3d(1.0, 3.0, 3.0)).norm(), 1e-15);
}

RC_GTEST_PROP(Rigid3, IsAGroup, ()) {
  const Rigid3 a = random_rigid(), b = random_rigid(), c = random_rigid();
  RC_ASSERT(difference((a * b) * c, a * (b * c)) < 1e-13);
  RC_ASSERT(difference(a * Rigid3{}, a) < 1e-14);
  RC_ASSERT(difference(Rigid3{} * a, a) < 1e-14);
  RC_ASSERT(difference(a * a.inverse(), {}) < 1e-13);
  RC_ASSERT(difference(a.inverse() * a, {}) < 1e-13);
}

RC_GTEST_PROP(Rigid3, ActsOnPointsAsItComposes, ()) {
  const Rigid3 a = random_rigid(), b = random_rigid();
  const Eigen::Vector3d p = random_vector(10.0);
  RC_ASSERT(((a * b) * p - a * (b * p)).norm() < 1e-13);
}

TEST(Rigid3, StaysAUnitRotationOverAMillionProducts) {
  Rigid3 T;
  const Rigid3 step{so3_exp({0.01, -0.02, 0.03}), {0.0, 0.0, 0.0}};
  for (int i = 0; i < 1'000'000; ++i) T = T * step;
  EXPECT_NEAR(T.rotation.norm(), 1.0, 1e-15);
}

TEST(So3, TurnsCounterClockwiseAboutTheAxis) {
  const Eigen::Vector3d turned = so3_exp({0.0, 0.0, 0.5}) * Eigen::Vector3d::UnitX();
  EXPECT_LT((turned - Eigen::Vector3d(std::cos(0.5), std::sin(0.5), 0.0)).norm(), 1e-15);
}

RC_GTEST_PROP(So3, LogUndoesExpUpToHalfATurn, ()) {
  const Eigen::Vector3d phi = random_rotation_vector();
  RC_ASSERT((so3_log(so3_exp(phi)) - phi).norm() < 1e-14 * (1.0 + phi.norm()));
}

RC_GTEST_PROP(So3, ExpUndoesLogForBothSignsOfTheQuaternion, ()) {
  const Eigen::Quaterniond q = so3_exp(random_rotation_vector());
  const Eigen::Quaterniond minus_q(-q.coeffs());
  RC_ASSERT(so3_exp(so3_log(q)).angularDistance(q) < 1e-7);  // angularDistance itself has half the digits
  RC_ASSERT((so3_exp(so3_log(minus_q)).toRotationMatrix() - q.toRotationMatrix()).norm() < 1e-14);
  RC_ASSERT(so3_log(minus_q).norm() <= std::numbers::pi);
}

RC_GTEST_PROP(So3, LogOfExactlyHalfATurnIsOneOfTheTwoAxes, ()) {
  const Eigen::Vector3d axis = random_axis();
  const Eigen::Vector3d phi = so3_log(Eigen::Quaterniond(0.0, axis.x(), axis.y(), axis.z()));
  RC_ASSERT(std::abs(phi.norm() - std::numbers::pi) < 1e-14);
  RC_ASSERT(phi.cross(axis).norm() < 1e-14);
}

RC_GTEST_PROP(So3, LeftJacobianMatchesDifferences, ()) {
  const Eigen::Vector3d phi = random_rotation_vector();
  RC_ASSERT((so3_left_jacobian(phi) - left_jacobian_by_differences(phi)).norm() < 1e-8);
}

RC_GTEST_PROP(So3, LeftJacobianTimesItsInverseIsOne, ()) {
  const Eigen::Vector3d phi = random_rotation_vector();
  const Eigen::Matrix3d product = so3_left_jacobian(phi) * so3_left_jacobian_inverse(phi);
  RC_ASSERT((product - Eigen::Matrix3d::Identity()).norm() < 1e-13);
}

RC_GTEST_PROP(Se3, LogUndoesExpUpToHalfATurn, ()) {
  const Vector6d xi = random_tangent(10.0);
  RC_ASSERT((se3_log(se3_exp(xi)) - xi).norm() < 1e-12);
}

RC_GTEST_PROP(Se3, ExpIsManySmallSteps, ()) {
  const Vector6d xi = random_tangent(2.0);
  Rigid3 T = se3_exp(xi / 1024.0);
  for (int doubling = 0; doubling < 10; ++doubling) T = T * T;
  RC_ASSERT(difference(T, se3_exp(xi)) < 1e-11);
}

RC_GTEST_PROP(Se3, AdjointMovesATangentToTheOtherSide, ()) {
  const Rigid3 T = random_rigid();
  const Vector6d xi = random_tangent(1.0);
  RC_ASSERT(difference(T * se3_exp(xi) * T.inverse(), se3_exp(adjoint(T) * xi)) < 1e-12);
}

RC_GTEST_PROP(Retract, IsUndoneByLocal, ()) {
  const Rigid3 T = random_rigid(), other = random_rigid();
  const Vector6d xi = random_tangent(1.0);
  RC_ASSERT((local(T, retract(T, xi)) - xi).norm() < 1e-13);
  RC_ASSERT(difference(retract(T, local(T, other)), other) < 1e-13);
}

RC_GTEST_PROP(Retract, ShiftsAlongTheAxesOfTheLeftFrameAndTurnsAboutTheOwnOrigin, ()) {
  const Rigid3 T_a_b = random_rigid();
  const Vector6d xi = random_tangent(1.0);
  const Rigid3 moved = retract(T_a_b, xi);
  RC_ASSERT((moved.translation - (T_a_b.translation + xi.head<3>())).norm() < 1e-14);
  const Eigen::Vector3d v_b = random_vector(1.0);
  RC_ASSERT((moved.rotation * v_b - so3_exp(xi.tail<3>()) * (T_a_b.rotation * v_b)).norm() < 1e-14);
}

RC_GTEST_PROP(Interpolate, GoesFromOneEndToTheOther, ()) {
  const Rigid3 a = random_rigid(), b = random_rigid();
  RC_PRE(rotation_angle_rad(a.inverse() * b) < 3.14);  // at half a turn both ways round are right
  RC_ASSERT(difference(interpolate(a, b, 0.0), a) < 1e-13);
  RC_ASSERT(difference(interpolate(a, b, 1.0), b) < 1e-12);
  const Rigid3 half = interpolate(a, b, 0.5);
  RC_ASSERT(difference(half * (a.inverse() * half), b) < 1e-11);
}

RC_GTEST_PROP(RotationAngle, IsTheAngleTurned, ()) {
  const Eigen::Vector3d phi = random_rotation_vector();
  RC_ASSERT(std::abs(rotation_angle_rad({so3_exp(phi), random_vector(1.0)}) - phi.norm()) < 1e-14);
}

}  // namespace povslam
