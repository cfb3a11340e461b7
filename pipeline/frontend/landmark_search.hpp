// Predicts where landmarks and the last frame's points appear in a frame, and finds the features that show them.
#pragma once

#include "pipeline/frontend/local_map.hpp"
#include "pipeline/frontend/map.hpp"
#include "pipeline/frontend/match.hpp"
#include "pipeline/geometry/camera.hpp"

namespace povslam {

// Tags in the matcher: a landmark's slot, or kPointOfLast + a feature of the last frame that has depth but no landmark.
inline constexpr std::int32_t kPointOfLast = 1 << 30;

class LandmarkSearch {
 public:
  LandmarkSearch(const PinholeCamera& camera, const FrontendOptions& options);

  // All the last frame saw, within radius_px of where T_camera_world puts it.
  void match_last(const Map& map, const Frame& last, const Frame& frame, const Rigid3& T_camera_world, float radius_px,
                  Matcher& matcher) const;
  // Landmarks of the local map; counts them as visible. widening multiplies the search radius.
  void match_local(Map& map, std::span<const std::int32_t> landmarks, const Frame& frame, const Rigid3& T_camera_world,
                   float widening, Matcher& matcher) const;
  // More of them, on features that show none yet.
  void match_more(Map& map, std::span<const std::int32_t> landmarks, const Frame& frame, const Rigid3& T_camera_world,
                  float widening, Matcher& matcher) const;
  // Any feature that looks like the landmark where it might show if it, or the camera, were up to reach_m elsewhere.
  // Whether it is believed or not.
  void match_wide(const Map& map, std::span<const std::int32_t> landmarks, const Frame& frame,
                  const Rigid3& T_camera_world, double reach_m, Matcher& matcher) const;

 private:
  PinholeCamera camera_;
  double log_scale_;
  int num_levels_;
};

}  // namespace povslam
