#include "pipeline/objects/object.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace povslam {
namespace {

constexpr double kBoxTrim = 0.01;

// How much of the surface faces along +x, -x, +y, -y, +z, -z of the box.
std::array<int, 6> seen_sides(std::span<const SurfacePoint> surface, double yaw) {
  std::array<int, 6> seen{};
  const Eigen::AngleAxisf turn(static_cast<float>(-yaw), Eigen::Vector3f::UnitZ());
  for (const SurfacePoint& point : surface) {
    const Eigen::Vector3f normal = turn * point.normal;
    for (int axis = 0; axis < 3; ++axis) {
      if (normal[axis] > 0.8F) ++seen[2 * axis];
      if (normal[axis] < -0.8F) ++seen[2 * axis + 1];
    }
  }
  return seen;
}

// Too little of a side to say where it lies.
bool hardly_seen(int side, int opposite) {
  return side <= std::max(5, (side + opposite) / 10);
}

// Moves the box's end on one side outwards, or inwards.
void move_end(Box& box, int axis, bool plus, double by_m) {
  Eigen::Vector3d outwards = Eigen::Vector3d::Zero();
  outwards[axis] = plus ? 0.5 * by_m : -0.5 * by_m;
  box.size_m[axis] += by_m;
  box.center += Eigen::AngleAxisd(box.yaw, Eigen::Vector3d::UnitZ()) * outwards;
}

// Points of a surface are one to a voxel, in its middle: where a side ends that no other side meets, the last of them
// lies half a voxel before the end in the mean.
void reach_ends(Box& box, const std::array<int, 6>& seen, double voxel_m) {
  for (int axis = 0; axis < 3; ++axis) {
    const int plus = seen[2 * axis], minus = seen[2 * axis + 1];
    if (hardly_seen(plus, minus)) move_end(box, axis, true, 0.5 * voxel_m);
    if (hardly_seen(minus, plus)) move_end(box, axis, false, 0.5 * voxel_m);
  }
}

// Grows the box along one axis away from its one seen side.
void assume_depth(Box& box, int axis, const std::array<int, 6>& seen, double depth_m) {
  const int plus = seen[2 * axis], minus = seen[2 * axis + 1];
  if (hardly_seen(plus, minus) == hardly_seen(minus, plus) || box.size_m[axis] >= depth_m) return;
  move_end(box, axis, hardly_seen(plus, minus), depth_m - box.size_m[axis]);
}

}  // namespace

double yaw_of(const Rigid3& T) {
  const Eigen::Vector3d forward = T.rotation * Eigen::Vector3d::UnitX();
  return std::atan2(forward.y(), forward.x());
}

Rigid3 upright(const Eigen::Vector3d& position, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), position};
}

double shape_weight(const MapObject& object) {
  constexpr double kLooks = 0.25,
                   kShare = 0.15;  // of all, of a thing hardly seen: another may hide a part of it in most
  return std::min(kLooks, kShare * object.looks);
}

std::uint16_t MapObject::class_id() const {
  const auto most = std::max_element(class_votes.begin(), class_votes.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == class_votes.end() ? std::uint16_t{0} : most->first;
}

Box MapObject::moved(const Box& box, const Rigid3& T) {
  return {T * box.center, box.size_m, fold_half_turn(box.yaw + yaw_of(T))};
}

std::optional<SeenBox> seen_box(std::span<const SurfacePoint> surface, double voxel_m) {
  std::vector<Eigen::Vector3f> all, sides;
  for (const SurfacePoint& point : surface) {
    all.push_back(point.p_volume);
    if (std::abs(point.normal.z()) < 0.5F) sides.push_back(point.p_volume);
  }
  if (all.size() < 3) return std::nullopt;
  const double yaw = fit_box(3 * sides.size() >= all.size() ? sides : all, kBoxTrim).yaw;
  SeenBox seen{fit_box_at(all, yaw, kBoxTrim), seen_sides(surface, yaw)};
  reach_ends(seen.box, seen.sides, voxel_m);
  return seen;
}

Box with_depth(const SeenBox& seen, double deepest_m) {
  Box box = seen.box;
  const Eigen::Vector3d& size = seen.box.size_m;
  assume_depth(box, 0, seen.sides, std::min({size.y(), size.z(), deepest_m}));
  assume_depth(box, 1, seen.sides, std::min({size.x(), size.z(), deepest_m}));
  return box;
}

Box with_known_depth(const SeenBox& seen, double depth_m) {
  SeenBox deep{with_depth(seen, depth_m), seen.sides};
  if (const auto front = front_side(seen)) assume_depth(deep.box, front->across, seen.sides, depth_m);
  return deep.box;
}

bool hardly_seen(const SeenBox& seen, int side) {
  return hardly_seen(seen.sides[static_cast<std::size_t>(side)], seen.sides[static_cast<std::size_t>(side ^ 1)]);
}

SeenBox grown(const SeenBox& seen, const HiddenReach& reach, double width_m, double height_m) {
  SeenBox out = seen;
  const auto front = front_side(seen);
  if (!front) return out;
  const int along = front->along();
  // Negative ones draw an end back; half of it is left.
  const double back_m = -std::min(reach.plus_m, 0.0) - std::min(reach.minus_m, 0.0);
  const double by = back_m > 0.0 ? std::min(1.0, 0.5 * out.box.size_m[along] / back_m) : 1.0;
  move_end(out.box, along, true, by * std::min(reach.plus_m, 0.0));
  move_end(out.box, along, false, by * std::min(reach.minus_m, 0.0));
  const double plus_m = std::max(reach.plus_m, 0.0), minus_m = std::max(reach.minus_m, 0.0), may_m = plus_m + minus_m;
  if (const double more_m = std::min(may_m, width_m - out.box.size_m[along]); may_m > 0.0 && more_m > 0.0) {
    move_end(out.box, along, true, more_m * plus_m / may_m);
    move_end(out.box, along, false, more_m * minus_m / may_m);
  }
  const double lower_m = std::min(reach.below_m, height_m - seen.box.size_m.z());
  if (lower_m > 0.0) move_end(out.box, 2, false, lower_m);
  return out;
}

std::optional<Box> box_of_surface(std::span<const SurfacePoint> surface, double voxel_m, double deepest_m) {
  const auto seen = seen_box(surface, voxel_m);
  return seen ? std::optional(with_depth(*seen, deepest_m)) : std::nullopt;
}

std::optional<double> depth_seen(const SeenBox& seen) {
  const auto shown = [&](int axis) {
    const int plus = seen.sides[2 * axis], minus = seen.sides[2 * axis + 1];
    return !hardly_seen(plus, minus) || !hardly_seen(minus, plus);
  };
  if (!shown(0) || !shown(1)) return std::nullopt;
  return seen.box.size_m.head<2>().minCoeff();
}

bool seen_whole(const MapObject& object) {
  constexpr double kHardly_m = 0.01;
  const Eigen::Vector2d added = (object.box.size_m - object.seen.box.size_m).head<2>();
  return depth_seen(object.seen).has_value() && added.maxCoeff() < kHardly_m;
}

void refresh_shape(MapObject& object, double min_weight, double deepest_m) {
  object.surface = surface_points(object.volume, min_weight);
  object.missed.assign(object.surface.size(), 0);
  const auto seen = seen_box(object.surface, object.volume.options().voxel_size_m);
  if (!seen) return;
  object.seen = *seen;
  object.box = with_depth(*seen, deepest_m);
}

}  // namespace povslam
