#include "drivers/synthetic/lidar.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "drivers/synthetic/random.hpp"

namespace povslam::synthetic {

namespace {

constexpr double kRangeSigma_m = 0.02;
constexpr double kLostShare = 0.01;
constexpr double kMinRange_m = 0.3;
constexpr float kFloorIntensity = 20.0F;

Eigen::Vector3d beam(double azimuth_rad, double elevation_rad) {
  const SinCos around = sin_cos(azimuth_rad), up = sin_cos(elevation_rad);
  return {up.cos * around.cos, up.cos * around.sin, up.sin};
}

}  // namespace

void Lidar::place_targets(double time_s) {
  targets_.clear();
  for (const Object& object : world_.scene().objects) {
    const Placement place = object.at(time_s);
    if (!place.present) continue;
    const SinCos yaw = sin_cos(place.yaw);
    for (const Part& part : object.parts) {
      const Eigen::Vector3d& c = part.center_object;
      const Eigen::Vector3d turned(yaw.cos * c.x() - yaw.sin * c.y(), yaw.sin * c.x() + yaw.cos * c.y(), c.z());
      targets_.push_back({place.position + turned, part.half_m, yaw.sin, yaw.cos, part.half_m.head<2>().norm(),
                          30.0F + 10.0F * static_cast<float>(part.paint)});
    }
  }
}

void Lidar::select(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
  near_.clear();
  const Eigen::Vector2d ahead = direction.head<2>().normalized();
  for (const Target& target : targets_) {
    const Eigen::Vector2d to = (target.center - from).head<2>();
    const double aside = std::abs(ahead.x() * to.y() - ahead.y() * to.x());
    // The body's tremble turns a column's beams apart by less than a centimetre a metre.
    if (aside <= target.radius_m + 0.01 * to.norm() && ahead.dot(to) >= -target.radius_m) near_.push_back(&target);
  }
}

// Slab test in each box's own axes; the floor is z = 0.
Lidar::Return Lidar::cast(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const {
  Return nearest{std::numeric_limits<double>::max(), 0.0F};
  if (direction.z() < 0.0) nearest = {-from.z() / direction.z(), kFloorIntensity};
  for (const Target* target : near_) {
    const auto turned = [target](const Eigen::Vector3d& v) {
      return Eigen::Vector3d(target->cos_yaw * v.x() + target->sin_yaw * v.y(),
                             -target->sin_yaw * v.x() + target->cos_yaw * v.y(), v.z());
    };
    const Eigen::Vector3d origin = turned(from - target->center), ray = turned(direction);
    double enter = 0.0, leave = nearest.range_m;
    for (int axis = 0; axis < 3; ++axis) {
      const double inverse = 1.0 / ray[axis];  // infinite along a face: then both bounds are, with the right signs
      const double a = (-target->half_m[axis] - origin[axis]) * inverse,
                   b = (target->half_m[axis] - origin[axis]) * inverse;
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (enter < leave && enter > 0.0) nearest = {enter, target->intensity};
  }
  return nearest;
}

void Lidar::scan(double time_s, LidarFrame& frame) {
  frame.points.clear();
  place_targets(time_s);
  const double noise = world_.options().noise;
  Random random(mix(mix(world_.options().seed, 606), static_cast<std::uint64_t>(time_s * 1e6 + 0.5)));
  for (int column = 0; column < kColumns; ++column) {
    const double offset_s = column / (kRate_hz * kColumns);
    const double azimuth_rad = 2.0 * kPi * column / kColumns - kPi;
    const Rigid3 T_world_lidar = world_.T_world_body(time_s + offset_s) * RobotMotion::T_body_lidar();
    const Eigen::Matrix3d R_world_lidar = T_world_lidar.matrix3();
    select(T_world_lidar.translation, R_world_lidar * beam(azimuth_rad, 0.0));
    for (int ring = 0; ring < kRings; ++ring) {
      const double elevation_rad = (-15.0 + 30.0 * ring / (kRings - 1)) * kPi / 180.0;
      const Eigen::Vector3d direction = beam(azimuth_rad, elevation_rad);
      const Return hit = cast(T_world_lidar.translation, R_world_lidar * direction);
      const double range_m = hit.range_m + noise * kRangeSigma_m * random.gaussian();
      const bool lost = random.chance(std::min(1.0, noise) * kLostShare);
      if (lost || hit.range_m > kMaxRange_m || range_m < kMinRange_m) continue;
      const Eigen::Vector3f p_lidar = (range_m * direction).cast<float>();
      frame.points.push_back({p_lidar.x(), p_lidar.y(), p_lidar.z(), hit.intensity, static_cast<float>(offset_s),
                              static_cast<std::uint16_t>(ring)});
    }
  }
}

}  // namespace povslam::synthetic
