// Generators of random geometry for property tests.
#pragma once

#include <rapidcheck.h>

#include <numbers>

#include "pipeline/geometry/rigid.hpp"

namespace povslam::testing {

inline double random_in(double low, double high) {
  constexpr int kSteps = 1'000'000;
  return low + (high - low) * *rc::gen::inRange(0, kSteps + 1) / kSteps;
}

inline Eigen::Vector3d random_vector(double extent) {
  const double x = random_in(-extent, extent), y = random_in(-extent, extent), z = random_in(-extent, extent);
  return {x, y, z};
}

inline Eigen::Vector3d random_axis() {
  const double z = random_in(-1.0, 1.0), angle = random_in(-std::numbers::pi, std::numbers::pi);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

// A rotation vector; the angle prefers the places where formulas break: zero, tiny, and just below pi.
inline Eigen::Vector3d random_rotation_vector() {
  const double angle = *rc::gen::oneOf(
      rc::gen::exec([] { return random_in(0.0, std::numbers::pi); }),
      rc::gen::element(0.0, 1e-12, 1e-9, 1e-7, 9.9e-6, 1.1e-5, 1e-4, 0.0999, 0.1001, 1.0, std::numbers::pi / 2),
      rc::gen::map(rc::gen::inRange(2, 13),
                   [](int digits) { return std::numbers::pi - std::pow(10.0, -static_cast<double>(digits)); }));
  return angle * random_axis();
}

inline Vector6d random_tangent(double extent_m) {
  Vector6d xi;
  xi << random_vector(extent_m), random_rotation_vector();
  return xi;
}

inline Rigid3 random_rigid(double extent_m = 10.0) {
  return {so3_exp(random_rotation_vector()), random_vector(extent_m)};
}

// Largest difference of what two motions do to points within a metre of the origin.
inline double difference(const Rigid3& a, const Rigid3& b) {
  return (a.matrix3() - b.matrix3()).norm() + (a.translation - b.translation).norm();
}

}  // namespace povslam::testing
