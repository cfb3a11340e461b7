// How an observation lies on an object's surface: the small upright motion that fits it best, point to plane.
#pragma once

#include <span>

#include "pipeline/mapping/volume.hpp"
#include "pipeline/objects/observation.hpp"

namespace povslam {

struct Registration {
  Rigid3 T_fitted_observed;  // moves the observation's points onto the object, world; identity when not tried
  double shift_m = 0.0;      // of the observation's middle
  double turn_rad = 0.0;
  int points = 0;
  int known = 0;                 // of the points lie where the object's volume knows something…
  int inliers = 0;               // …of which so many on its surface
  int before = 0;                // …and so many clearly before it, in space held for free, before any motion
  double most_turned_m = 0.0;    // how far the turn alone moves the observation's outermost points
  double mean_distance_m = 0.0;  // of the known ones from the surface, before any motion
};

// Point to plane, plane and distance from the signed distance field, restricted to (x, y, z, yaw), with a prior at no
// motion for what the surface does not hold (a plane slides along itself).
Registration register_points(const Observation& observation, const Volume& volume, const Rigid3& T_world_volume,
                             double inlier_m);

}  // namespace povslam
