// Options of the frontend: plain values with defaults, validated once where they enter (daemon/config_file).
#pragma once

#include <string>

#include "pipeline/frontend/orb.hpp"

namespace povslam {

// Measurement noise, one standard deviation.
struct NoiseOptions {                           // the tracker learns factors on these
  double pixel_sigma_px = 0.8;                  // feature position on pyramid level 0; grows with the level's scale
  double patch_sigma_px = 0.15;                 // of a position found by fitting the landmark's patch, likewise
  double depth_sigma_quadratic_per_m = 0.0025;  // sigma_z = this * z^2: of inverse depth [1/m] a constant
  double depth_sigma_floor_m = 0.003;           // added in quadrature
  double min_depth_m = 0.3;
  double max_depth_m = 10.0;
};

struct TrackOptions {
  double search_radius_px = 15.0;  // around the predicted position, level 0; doubled when too few match
  int min_inliers_ok = 30;         // landmarks for state OK
  int min_inliers_degraded = 12;   // landmarks below which the pose is not trusted at all
  int object_landmarks = 24;  // seen of a small believed thing; of one with fewer more features are wanted; 0: never
  int frames_to_recover = 3;  // good frames in a row before DEGRADED becomes OK
  int frames_to_lost = 3;     // frames in a row without a pose before LOST
};

struct MapOptions {
  int max_keyframes = 1200;
  int max_landmarks = 120000;
  int keyframe_min_frames = 3;  // between two keyframes
  int keyframe_max_frames = 30;
  int smooth_max_poses = 24;        // keyframes moved by local bundle adjustment
  int smooth_max_fixed_poses = 24;  // keyframes that see the same landmarks and hold the window
  int smooth_max_points = 6000;
  int smooth_max_observations = 40000;
  double change_period_s = 2.0;  // between two takings of what changed, for the map on disk
  std::string mode = "map";      // "localise": the map stays as it is
  std::string start = "search";  // on an existing map: anywhere; "known": where the start pose says, then anywhere
};

struct FrontendOptions {
  OrbOptions orb;
  NoiseOptions noise;
  TrackOptions track;
  MapOptions map;
};

}  // namespace povslam
