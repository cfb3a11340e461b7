#include "pipeline/geometry/camera.hpp"

#include <Eigen/LU>
#include <cmath>

namespace povslam {
namespace {

constexpr double kMaxRadiusSquared = 1e12;  // a ray in the image plane itself: its pixel would not be a number

// d distort / d ideal.
Eigen::Matrix2d distort_jacobian(const std::array<double, 5>& distortion, const Eigen::Vector2d& ideal) {
  const auto& [k1, k2, p1, p2, k3] = distortion;
  const double x = ideal.x(), y = ideal.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double slope = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);  // d radial / d r2
  const double mixed = 2.0 * (x * y * slope + p1 * x + p2 * y);
  Eigen::Matrix2d J;
  J << radial + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x, mixed,  //
      mixed, radial + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x;
  return J;
}

// Whether the seen radius stops growing with the ideal one somewhere up to r2: d (r radial) / dr has a root there.
bool folds_before(const std::array<double, 5>& distortion, double r2) {
  const double a = 3.0 * distortion[0], b = 5.0 * distortion[1], c = 7.0 * distortion[4];
  const auto falls_at = [&](double u) { return u > 0.0 && u <= r2 && 1.0 + u * (a + u * (b + u * c)) <= 0.0; };
  if (falls_at(r2)) return true;
  const double discriminant = b * b - 3.0 * a * c;  // of the derivative by u: a + 2 b u + 3 c u^2
  if (c == 0.0 || discriminant < 0.0) return b != 0.0 && c == 0.0 && falls_at(-a / (2.0 * b));
  const double root = std::sqrt(discriminant);
  return falls_at((-b + root) / (3.0 * c)) || falls_at((-b - root) / (3.0 * c));
}

}  // namespace

bool PinholeCamera::distorted() const {
  for (const double k : distortion) {
    if (k != 0.0) return true;
  }
  return false;
}

Eigen::Vector2d PinholeCamera::distort(const Eigen::Vector2d& ideal) const {
  const auto& [k1, k2, p1, p2, k3] = distortion;
  const double x = ideal.x(), y = ideal.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
          y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
}

Eigen::Vector2d PinholeCamera::undistort(const Eigen::Vector2d& seen) const {
  if (!distorted()) return seen;
  Eigen::Vector2d ideal = seen;
  Eigen::Vector2d error = seen - distort(ideal);
  for (int i = 0; i < 30 && error.squaredNorm() > 1e-18; ++i) {
    Eigen::Vector2d step = distort_jacobian(distortion, ideal).inverse() * error;
    Eigen::Vector2d next_error = seen - distort(ideal + step);
    for (int halving = 0; halving < 10 && !(next_error.squaredNorm() < error.squaredNorm()); ++halving) {
      step *= 0.5;
      next_error = seen - distort(ideal + step);
    }
    if (!(next_error.squaredNorm() < error.squaredNorm())) break;
    ideal += step;
    error = next_error;
  }
  return ideal;
}

std::optional<Eigen::Vector2d> PinholeCamera::project(const Eigen::Vector3d& p_camera) const {
  if (!(p_camera.z() > 0.0)) return std::nullopt;
  const Eigen::Vector2d ideal = p_camera.head<2>() / p_camera.z();
  const double r2 = ideal.squaredNorm();
  if (!(r2 < kMaxRadiusSquared) || folds_before(distortion, r2)) return std::nullopt;
  const Eigen::Vector2d seen = distort(ideal);
  return Eigen::Vector2d(fx * seen.x() + cx, fy * seen.y() + cy);
}

Eigen::Vector3d PinholeCamera::unproject(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d ideal = undistort({(pixel.x() - cx) / fx, (pixel.y() - cy) / fy});
  return {ideal.x(), ideal.y(), 1.0};
}

Eigen::Vector2d PinholeCamera::rectify(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector3d ray = unproject(pixel);
  return {fx * ray.x() + cx, fy * ray.y() + cy};
}

}  // namespace povslam
