// A point of the world that features of several keyframes see.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "pipeline/frontend/orb.hpp"
#include "pipeline/geometry/rigid.hpp"

namespace povslam {

struct LandmarkSighting {
  std::int32_t keyframe = -1;  // slot in the map
  std::int32_t feature = -1;   // index in the keyframe
};

inline constexpr int kMaxSightings = 32;

struct Landmark {
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();
  Eigen::Vector3d toward_camera = Eigen::Vector3d::Zero();  // unit, mean direction it was seen from
  Descriptor descriptor{};                                  // the one closest to all others of its sightings
  float reference_distance_m = 1.0F;                        // of the sighting that gave the descriptor…
  std::uint8_t reference_level = 0;  // …and its pyramid level: predicts the level at another distance
  bool alive = false;
  bool has_patch = false;  // its look at first sight is kept (Map::patch)…
  Eigen::Vector3f tangent_x =
      Eigen::Vector3f::Zero();  // …on a surface where one px of the patch spans these [m, world]
  Eigen::Vector3f tangent_y = Eigen::Vector3f::Zero();
  std::int64_t id = -1;          // unique for ever within one map
  std::uint32_t generation = 0;  // of the slot
  std::int64_t born_keyframe = -1;
  std::int64_t owner = -1;   // object it is part of (> 0); 0: structure; -1: not known
  std::int32_t anchor = -1;  // keyframe slot it moves with when that is corrected
  std::int32_t visible = 0;  // frames in which it should have been seen…
  std::int32_t found = 0;    // …and was
  std::int64_t mark = -1;    // scratch of whoever walks the map: last visited in …
  int num_sightings = 0;
  std::array<LandmarkSighting, kMaxSightings> sightings{};
};

// Pyramid level at which a point seen on level_reference from distance_reference_m is found from distance_m: a point
// twice as far looks half as large and is found lower in the pyramid. log_scale: ln of the levels' size ratio.
inline int predicted_level(double level_reference, double distance_reference_m, double distance_m, double log_scale) {
  const double level = level_reference + std::log(distance_reference_m / distance_m) / log_scale;
  return static_cast<int>(std::lround(std::clamp(level, -100.0, 100.0)));
}

}  // namespace povslam
