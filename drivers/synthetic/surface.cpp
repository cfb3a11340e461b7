#include "drivers/synthetic/surface.hpp"

#include <cmath>

#include "drivers/synthetic/faces.hpp"
#include "drivers/synthetic/random.hpp"

namespace povslam::synthetic {

namespace {

constexpr double kOnFloor_m = 1e-6;

bool inside_another_part(const Object& object, std::size_t own, const Eigen::Vector3d& p_object) {
  constexpr double kDeep_m = 1e-3;
  for (std::size_t i = 0; i < object.parts.size(); ++i) {
    const Part& part = object.parts[i];
    const Eigen::Vector3d beyond = (p_object - part.center_object).cwiseAbs() - part.half_m;
    if (i != own && beyond.maxCoeff() < -kDeep_m) return true;
  }
  return false;
}

void sample_face(const FaceShape& face, double spacing_m, std::vector<Eigen::Vector3d>& points) {
  const int columns = std::max(1, static_cast<int>(std::ceil(face.across.norm() / spacing_m)));
  const int rows = std::max(1, static_cast<int>(std::ceil(face.down.norm() / spacing_m)));
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      points.push_back(face.corner + face.across * (static_cast<double>(column) / columns) +
                       face.down * (static_cast<double>(row) / rows));
    }
  }
}

}  // namespace

std::vector<SurfacePoint> final_surface(const Scene& scene, double spacing_m) {
  std::vector<SurfacePoint> surface;
  std::vector<Eigen::Vector3d> points;
  for (const Object& object : scene.objects) {
    if (object.walk || !object.after.present) continue;
    const SinCos yaw = sin_cos(object.after.yaw);
    const Eigen::Vector3d& at = object.after.position;
    const auto turned = [&yaw](const Eigen::Vector3d& v) {
      return Eigen::Vector3d(yaw.cos * v.x() - yaw.sin * v.y(), yaw.sin * v.x() + yaw.cos * v.y(), v.z());
    };
    for (std::size_t i = 0; i < object.parts.size(); ++i) {
      for (const FaceShape& face : faces_of(object.parts[i])) {
        if (face.normal.z() < 0.0 && face.corner.z() + at.z() < kOnFloor_m) continue;
        points.clear();
        sample_face(face, spacing_m, points);
        for (const Eigen::Vector3d& p : points) {
          if (inside_another_part(object, i, p)) continue;
          surface.push_back({(at + turned(p)).cast<float>(), turned(face.normal).cast<float>()});
        }
      }
    }
  }
  return surface;
}

}  // namespace povslam::synthetic
