// What one view shows of one thing.
#pragma once

#include <vector>

#include "pipeline/geometry/rigid.hpp"
#include "pipeline/mapping/depth_view.hpp"

namespace povslam {

struct Box {                                         // upright
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  // along its own axes
  double yaw = 0.0;                                  // rad, in (-pi/2, pi/2]: of its x axis

  bool contains(const Eigen::Vector3d& p, double grow_m = 0.0) const {
    const Eigen::Vector3d q = Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitZ()) * (p - center);
    return (q.cwiseAbs() - 0.5 * size_m).maxCoeff() <= grow_m;
  }
};

struct Fence {                  // upright plane
  Eigen::Vector2d at, outward;  // horizontal, world: a point of it, and towards the other thing (unit)
};

struct Observation {
  std::uint16_t owner = kNobody;  // of its pixels in the view
  std::uint16_t class_id = 0;
  int votes = 1;              // for the class of the object it is of; 0: nobody asked
  bool class_binds = true;    // false: the class is a name given to a segment; a thing may have another in each view
  int pixels = 0;             // of the full image
  bool partial = false;       // reaches the image's border or its range: its extent is not known
  std::vector<Fence> fences;  // where a groove or gap separates it from another of its class
  double median_depth_m = 0.0;
  std::vector<Eigen::Vector3f> points_world;  // thinned to the spacing
  std::vector<float> sigma_m;                 // of each, along the ray
  Box box;                                    // of these points, world
};

}  // namespace povslam
