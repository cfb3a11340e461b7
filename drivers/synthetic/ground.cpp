#include "drivers/synthetic/ground.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "drivers/synthetic/random.hpp"

namespace povslam::synthetic {

namespace {

Eigen::Vector2d into_frame(const Footprint& frame, const Eigen::Vector2d& p_world) {
  const SinCos yaw = sin_cos(frame.yaw);
  const Eigen::Vector2d d = p_world - frame.center;
  return {yaw.cos * d.x() + yaw.sin * d.y(), -yaw.sin * d.x() + yaw.cos * d.y()};
}

// Separating axes of `a` only.
bool separated_along(const Footprint& a, const Footprint& b, double gap_m) {
  const Eigen::Vector2d center = into_frame(a, b.center);
  const SinCos turn = sin_cos(b.yaw - a.yaw);
  const double reach_x = std::abs(turn.cos) * b.half_m.x() + std::abs(turn.sin) * b.half_m.y();
  const double reach_y = std::abs(turn.sin) * b.half_m.x() + std::abs(turn.cos) * b.half_m.y();
  return std::abs(center.x()) > a.half_m.x() + reach_x + gap_m || std::abs(center.y()) > a.half_m.y() + reach_y + gap_m;
}

}  // namespace

Footprint footprint(const Object& object, const Placement& placement) {
  return {placement.position.head<2>(), 0.5 * object.size_m.head<2>(), placement.yaw};
}

bool overlap(const Footprint& a, const Footprint& b, double gap_m) {
  return !separated_along(a, b, gap_m) && !separated_along(b, a, gap_m);
}

double distance_m(const Footprint& footprint, const Eigen::Vector2d& p_world) {
  const Eigen::Vector2d p = into_frame(footprint, p_world).cwiseAbs() - footprint.half_m;
  return p.cwiseMax(0.0).norm();
}

std::vector<Eigen::Vector2d> sample_path(const LapPath& path) {
  std::vector<Eigen::Vector2d> points;
  for (double s = 0.0; s < path.length_m(); s += 0.05) {
    const LapPath::Pose2 pose = path.at(s);
    points.emplace_back(pose.x, pose.y);
  }
  return points;
}

double clearance_m(const Footprint& footprint, const std::vector<Eigen::Vector2d>& path) {
  double nearest = std::numeric_limits<double>::max();
  for (const Eigen::Vector2d& p : path) nearest = std::min(nearest, distance_m(footprint, p));
  return nearest;
}

}  // namespace povslam::synthetic
