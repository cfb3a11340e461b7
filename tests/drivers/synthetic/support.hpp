// A small, fast camera and worlds for the tests of the simulator.
#pragma once

#include <gtest/gtest.h>

#include "drivers/synthetic/world.hpp"

namespace povslam::synthetic {

inline SyntheticOptions small_options(const std::string& scene, std::uint64_t seed) {
  SyntheticOptions options;
  options.scene = scene;
  options.seed = seed;
  options.camera = {160, 120, 131.25, 131.25, 79.5, 59.5, {}};  // the standard camera at a quarter
  options.fps = 15.0;
  return options;
}

inline World make_world(const SyntheticOptions& options) {
  Result<World> world = World::create(options);
  EXPECTS(world);
  return std::move(*world);
}

// Distance along the ray to the nearest box or the floor by slab tests in each box's axes, written independently of
// the renderer's; infinity where it meets nothing.
inline double brute_force_range_m(const Scene& scene, double time_s, const Eigen::Vector3d& from,
                                  const Eigen::Vector3d& ray) {
  double nearest = ray.z() < 0.0 ? -from.z() / ray.z() : std::numeric_limits<double>::infinity();
  for (const Object& object : scene.objects) {
    const Placement place = object.at(time_s);
    if (!place.present) continue;
    const Eigen::Matrix3d R_object_world = Eigen::AngleAxisd(-place.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    for (const Part& part : object.parts) {
      const Eigen::Array3d origin = (R_object_world * (from - place.position) - part.center_object).array();
      const Eigen::Array3d direction = (R_object_world * ray).array();
      const Eigen::Array3d a = (-part.half_m.array() - origin) / direction,
                           b = (part.half_m.array() - origin) / direction;
      const double enter = a.min(b).maxCoeff(), leave = a.max(b).minCoeff();
      if (enter > 0.0 && enter < leave && enter < nearest) nearest = enter;
    }
  }
  return nearest;
}

}  // namespace povslam::synthetic
