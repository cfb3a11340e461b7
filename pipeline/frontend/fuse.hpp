// Joins two visits to one place: landmarks of the one are looked for in the keyframes of the other; what is found there
// twice becomes one. Bounded work a call, no allocation after construction.
#pragma once

#include <cstdint>
#include <span>

#include "pipeline/frontend/feature_grid.hpp"
#include "pipeline/frontend/map.hpp"
#include "pipeline/geometry/camera.hpp"

namespace povslam {

class LandmarkFuser {
 public:
  LandmarkFuser(const PinholeCamera& camera, const FrontendOptions& options);

  // Where a landmark projects onto a feature that looks like it and has its depth, the keyframe sees it from now on; a
  // landmark the feature had already is merged into it. Returns how many landmarks the keyframe gained.
  int fuse(Map& map, std::int32_t keyframe, std::span<const std::int32_t> landmarks);

 private:
  int find_feature(const Map& map, const Keyframe& kf, const Landmark& point) const;  // -1: none

  PinholeCamera camera_;
  double log_scale_;
  FeatureGrid grid_;
};

}  // namespace povslam
