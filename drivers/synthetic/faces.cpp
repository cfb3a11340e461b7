#include "drivers/synthetic/faces.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/synthetic/random.hpp"

namespace povslam::synthetic {

namespace {

constexpr double kNear_m = 0.02;

// A lamp high up and to one side, and light from everywhere.
double light_on(const Eigen::Vector3d& normal_world) {
  const Eigen::Vector3d lamp(0.36, 0.48, 0.8);
  return 0.62 + 0.38 * std::max(0.0, normal_world.dot(lamp)) + 0.08 * normal_world.x();
}

}  // namespace

std::array<FaceShape, kFacesPerPart> faces_of(const Part& part) {
  const Eigen::Vector3d& c = part.center_object;
  const double x = part.half_m.x(), y = part.half_m.y(), z = part.half_m.z();
  using V = Eigen::Vector3d;
  return {{{c + V(x, -y, z), V(0, 2 * y, 0), V(0, 0, -2 * z), V(1, 0, 0)},
           {c + V(-x, y, z), V(0, -2 * y, 0), V(0, 0, -2 * z), V(-1, 0, 0)},
           {c + V(x, y, z), V(-2 * x, 0, 0), V(0, 0, -2 * z), V(0, 1, 0)},
           {c + V(-x, -y, z), V(2 * x, 0, 0), V(0, 0, -2 * z), V(0, -1, 0)},
           {c + V(-x, y, z), V(2 * x, 0, 0), V(0, -2 * y, 0), V(0, 0, 1)},
           {c + V(x, y, -z), V(-2 * x, 0, 0), V(0, -2 * y, 0), V(0, 0, -1)}}};
}

View::View(const PinholeCamera& camera, const Rigid3& T_world_camera)
    : camera_(camera), T_camera_world_(T_world_camera.inverse()), p_world_(T_world_camera.translation) {
  const double left = (-0.5 - camera.cx) / camera.fx, right = (camera.width - 0.5 - camera.cx) / camera.fx;
  const double top = (-0.5 - camera.cy) / camera.fy, bottom = (camera.height - 0.5 - camera.cy) / camera.fy;
  sides_ = {Eigen::Vector3d(1, 0, -left).normalized(), Eigen::Vector3d(-1, 0, right).normalized(),
            Eigen::Vector3d(0, 1, -top).normalized(), Eigen::Vector3d(0, -1, bottom).normalized()};
}

bool View::may_see(const Eigen::Vector3d& center_world, double radius_m) const {
  const Eigen::Vector3d center = T_camera_world_ * center_world;
  if (center.z() < -radius_m) return false;
  return std::all_of(sides_.begin(), sides_.end(),
                     [&](const Eigen::Vector3d& side) { return side.dot(center) >= -radius_m; });
}

Affine View::over_pixels(const Eigen::Vector3d& over_ray) const {
  const double x = over_ray.x() / camera_.fx, y = over_ray.y() / camera_.fy;
  return {x, y, over_ray.z() - x * camera_.cx - y * camera_.cy};
}

Plane View::floor() const {
  const Eigen::Vector3d up_camera = T_camera_world_.rotation * Eigen::Vector3d::UnitZ();
  return {over_pixels(-up_camera / p_world_.z()), p_world_.z()};
}

void View::find_rows(const std::array<Eigen::Vector3d, 4>& corners_camera, ProjectedFace& face) const {
  double top = camera_.height, bottom = -1.0;
  for (const Eigen::Vector3d& corner : corners_camera) {
    if (corner.z() < kNear_m) {
      top = 0.0;
      bottom = camera_.height;
      break;
    }
    const double row = camera_.fy * corner.y() / corner.z() + camera_.cy;
    top = std::min(top, row);
    bottom = std::max(bottom, row);
  }
  face.row_begin = static_cast<int>(std::clamp(std::floor(top), 0.0, static_cast<double>(camera_.height)));
  face.row_end = static_cast<int>(std::clamp(std::ceil(bottom) + 1.0, 0.0, static_cast<double>(camera_.height)));
}

void View::add_faces(const Object& object, int object_index, const Placement& placement,
                     std::vector<ProjectedFace>& faces) const {
  if (!placement.present || !may_see(placement.position, 0.5 * object.size_m.norm())) return;
  const SinCos yaw = sin_cos(placement.yaw);
  Eigen::Matrix3d R_world_object;
  R_world_object << yaw.cos, -yaw.sin, 0.0, yaw.sin, yaw.cos, 0.0, 0.0, 0.0, 1.0;
  const Eigen::Matrix3d R_camera_object = T_camera_world_.matrix3() * R_world_object;
  const Eigen::Vector3d t_camera_object = T_camera_world_ * placement.position;
  for (std::size_t part = 0; part < object.parts.size(); ++part) {
    const Part& shape = object.parts[part];
    if (!may_see(placement.position + R_world_object * shape.center_object, shape.half_m.norm())) continue;
    const std::array<FaceShape, kFacesPerPart> shapes = faces_of(shape);
    for (int i = 0; i < kFacesPerPart; ++i) {
      const FaceShape& f = shapes[static_cast<std::size_t>(i)];
      const Eigen::Vector3d corner = R_camera_object * f.corner + t_camera_object;
      const Eigen::Vector3d normal = R_camera_object * f.normal;
      const double distance = -normal.dot(corner);
      if (distance < 1e-4) continue;
      const Eigen::Vector3d across = R_camera_object * f.across, down = R_camera_object * f.down;
      const double volume = corner.dot(across.cross(down));
      ProjectedFace face;
      face.s = over_pixels(down.cross(corner) / volume);
      face.t = over_pixels(corner.cross(across) / volume);
      face.plane = {over_pixels(across.cross(down) / volume), distance};
      face.object = object_index;
      face.surface = static_cast<int>(part) * kFacesPerPart + i;
      face.light = light_on(R_world_object * f.normal);
      find_rows({corner, corner + across, corner + down, corner + across + down}, face);
      if (face.row_begin < face.row_end) faces.push_back(face);
    }
  }
}

void find_faces(const Scene& scene, double time_s, const View& view, std::vector<ProjectedFace>& faces) {
  faces.clear();
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    view.add_faces(scene.objects[i], static_cast<int>(i), scene.objects[i].at(time_s), faces);
  }
}

}  // namespace povslam::synthetic
