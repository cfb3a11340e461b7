// The floor seen from above: what overlaps what, and how near it is to the robot's path.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "drivers/synthetic/motion.hpp"
#include "drivers/synthetic/scene.hpp"

namespace povslam::synthetic {

struct Footprint {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();  // world
  Eigen::Vector2d half_m = Eigen::Vector2d::Zero();  // along the footprint's own axes
  double yaw = 0.0;
};

Footprint footprint(const Object& object, const Placement& placement);

bool overlap(const Footprint& a, const Footprint& b, double gap_m);  // true when nearer than about gap_m
double distance_m(const Footprint& footprint, const Eigen::Vector2d& p_world);

std::vector<Eigen::Vector2d> sample_path(const LapPath& path);  // every 5 cm
double clearance_m(const Footprint& footprint, const std::vector<Eigen::Vector2d>& path);

}  // namespace povslam::synthetic
