#include "tools/povslam/scores/oriented_box.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace povslam::scores {
namespace {

using Polygon = std::vector<Eigen::Vector2d>;  // counter-clockwise

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

Eigen::Vector2d turned(const Eigen::Vector2d& v, double yaw_rad) {
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  return {c * v.x() - s * v.y(), s * v.x() + c * v.y()};
}

// Relative to `origin`, so that boxes far from it lose no digits.
Polygon footprint(const OrientedBox& box, const Eigen::Vector2d& origin) {
  const Eigen::Vector2d half = 0.5 * box.size_m.head<2>(), center = box.center_world.head<2>() - origin;
  Polygon corners;
  const Eigen::Vector2d signs[] = {{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}};
  for (const Eigen::Vector2d& sign : signs) {
    corners.push_back(center + turned(half.cwiseProduct(sign), box.yaw_rad));
  }
  return corners;
}

// Sutherland and Hodgman 1974, one edge: keeps what lies left of from -> to.
Polygon keep_left(const Polygon& polygon, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double side_p = cross(to - from, p - from), side_q = cross(to - from, q - from);
    if (side_p >= 0.0) kept.push_back(p);
    if ((side_p > 0.0 && side_q < 0.0) || (side_p < 0.0 && side_q > 0.0)) {
      kept.push_back(p + side_p / (side_p - side_q) * (q - p));
    }
  }
  return kept;
}

double area(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) twice += cross(polygon[i], polygon[(i + 1) % polygon.size()]);
  return 0.5 * twice;
}

}  // namespace

double intersection_volume(const OrientedBox& a, const OrientedBox& b) {
  const double top = std::min(a.center_world.z() + 0.5 * a.size_m.z(), b.center_world.z() + 0.5 * b.size_m.z());
  const double bottom = std::max(a.center_world.z() - 0.5 * a.size_m.z(), b.center_world.z() - 0.5 * b.size_m.z());
  if (top <= bottom) return 0.0;
  const Eigen::Vector2d origin = a.center_world.head<2>();
  Polygon common = footprint(a, origin);
  const Polygon clip = footprint(b, origin);
  for (std::size_t i = 0; i < clip.size() && !common.empty(); ++i) {
    common = keep_left(common, clip[i], clip[(i + 1) % clip.size()]);
  }
  return common.size() < 3 ? 0.0 : std::max(0.0, area(common)) * (top - bottom);
}

double box_iou(const OrientedBox& a, const OrientedBox& b) {
  const double common = intersection_volume(a, b);
  const double both = a.size_m.prod() + b.size_m.prod() - common;
  return both > 0.0 ? common / both : 0.0;
}

bool boxes_touch(const OrientedBox& a, const OrientedBox& b, double gap_m) {
  OrientedBox wider_a = a, wider_b = b;
  wider_a.size_m.array() += gap_m;
  wider_b.size_m.array() += gap_m;
  return intersection_volume(wider_a, wider_b) > 0.0;
}

OrientedBox joined(const OrientedBox& a, const OrientedBox& b) {
  Eigen::Vector3d low = -0.5 * a.size_m, high = 0.5 * a.size_m;  // in the axes of a, from its centre
  for (const Eigen::Vector2d& corner : footprint(b, a.center_world.head<2>())) {
    const Eigen::Vector2d p = turned(corner, -a.yaw_rad);
    low.head<2>() = low.head<2>().cwiseMin(p);
    high.head<2>() = high.head<2>().cwiseMax(p);
  }
  const double lift = b.center_world.z() - a.center_world.z();
  low.z() = std::min(low.z(), lift - 0.5 * b.size_m.z());
  high.z() = std::max(high.z(), lift + 0.5 * b.size_m.z());
  const Eigen::Vector3d middle = 0.5 * (low + high);
  OrientedBox box{a.center_world, high - low, a.yaw_rad};
  box.center_world.head<2>() += turned(middle.head<2>(), a.yaw_rad);
  box.center_world.z() += middle.z();
  return box;
}

double yaw_difference_mod_half_turn(double a_rad, double b_rad) {
  return std::abs(std::remainder(a_rad - b_rad, std::numbers::pi));
}

}  // namespace povslam::scores
