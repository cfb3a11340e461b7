#include "pipeline/geometry/camera.hpp"

namespace povslam {

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
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector2d error = seen - distort(ideal);
    ideal += error;
    if (error.squaredNorm() < 1e-18) break;
  }
  return ideal;
}

std::optional<Eigen::Vector2d> PinholeCamera::project(const Eigen::Vector3d& p_camera) const {
  if (p_camera.z() <= 0.0) return std::nullopt;
  const Eigen::Vector2d seen = distort(p_camera.head<2>() / p_camera.z());
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
