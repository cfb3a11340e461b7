#include "pipeline/objects/object.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace povslam {
namespace {

constexpr double kBoxTrim = 0.01;

// How much of the surface faces along +x, -x, +y, -y of the box.
std::array<int, 4> seen_sides(const std::vector<SurfacePoint>& surface, double yaw) {
  std::array<int, 4> seen{};
  const Eigen::Vector2f x(static_cast<float>(std::cos(yaw)), static_cast<float>(std::sin(yaw)));
  const Eigen::Vector2f y(-x.y(), x.x());
  for (const SurfacePoint& point : surface) {
    const float along_x = point.normal.head<2>().dot(x), along_y = point.normal.head<2>().dot(y);
    if (along_x > 0.8F) ++seen[0];
    if (along_x < -0.8F) ++seen[1];
    if (along_y > 0.8F) ++seen[2];
    if (along_y < -0.8F) ++seen[3];
  }
  return seen;
}

// A top that is seen is seen to its far edge: no depth is left to assume.
bool top_seen(const std::vector<SurfacePoint>& surface, const Box& box, double spacing_m) {
  constexpr double kShare = 0.5;
  const double top_m = box.center.z() + 0.5 * box.size_m.z() - spacing_m;
  const auto count = std::ranges::count_if(surface, [&](const SurfacePoint& point) {
    return point.normal.z() > 0.8F && static_cast<double>(point.p_volume.z()) > top_m;
  });
  return static_cast<double>(count) * spacing_m * spacing_m > kShare * box.size_m.x() * box.size_m.y();
}

double assumed_depth_m(double width_m, double height_m, double share) {
  constexpr double kDeepest_m = 1.0;
  return std::min(share * std::min(width_m, height_m), kDeepest_m);
}

// Grows the box along one axis away from its one seen side.
void assume_depth(Box& box, int axis, int seen_plus, int seen_minus, double depth_m) {
  const int few = std::max(5, (seen_plus + seen_minus) / 10);
  const bool plus = seen_plus > few, minus = seen_minus > few;
  if (plus == minus || box.size_m[axis] >= depth_m) return;
  const double grow = depth_m - box.size_m[axis];
  Eigen::Vector3d away = Eigen::Vector3d::Zero();
  away[axis] = (plus ? -0.5 : 0.5) * grow;
  box.size_m[axis] = depth_m;
  box.center += Eigen::AngleAxisd(box.yaw, Eigen::Vector3d::UnitZ()) * away;
}

}  // namespace

double yaw_of(const Rigid3& T) {
  const Eigen::Vector3d forward = T.rotation * Eigen::Vector3d::UnitX();
  return std::atan2(forward.y(), forward.x());
}

Rigid3 upright(const Eigen::Vector3d& position, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), position};
}

std::uint16_t MapObject::class_id() const {
  const auto most = std::max_element(class_votes.begin(), class_votes.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == class_votes.end() ? std::uint16_t{0} : most->first;
}

Box MapObject::moved(const Box& box, const Rigid3& T) {
  return {T * box.center, box.size_m, fold_half_turn(box.yaw + yaw_of(T))};
}

void refresh_shape(MapObject& object, double min_weight, double assumed_depth) {
  object.surface = surface_points(object.volume, min_weight);
  object.missed.assign(object.surface.size(), 0);
  std::vector<Eigen::Vector3f> all, sides;
  for (const SurfacePoint& point : object.surface) {
    all.push_back(point.p_volume);
    if (std::abs(point.normal.z()) < 0.5F) sides.push_back(point.p_volume);
  }
  if (all.size() < 3) return;
  const double yaw = fit_box(3 * sides.size() >= all.size() ? sides : all, kBoxTrim).yaw;
  object.box = fit_box_at(all, yaw, kBoxTrim);
  if (top_seen(object.surface, object.box, object.volume.options().voxel_size_m)) return;
  const std::array<int, 4> seen = seen_sides(object.surface, yaw);
  const Eigen::Vector3d size = object.box.size_m;
  assume_depth(object.box, 0, seen[0], seen[1], assumed_depth_m(size.y(), size.z(), assumed_depth));
  assume_depth(object.box, 1, seen[2], seen[3], assumed_depth_m(size.x(), size.z(), assumed_depth));
}

}  // namespace povslam
