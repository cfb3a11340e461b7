// What a correction of the tracker's map did to its keyframes, for what hangs on them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "pipeline/geometry/rigid.hpp"

namespace povslam {

struct KeyframeMotion {
  std::int64_t keyframe = -1;
  Rigid3 T_new_old;  // in the world
};

// motions: by ascending keyframe. Null: it did not move.
inline const Rigid3* motion_of(std::span<const KeyframeMotion> motions, std::int64_t keyframe) {
  const auto found = std::ranges::lower_bound(motions, keyframe, {}, &KeyframeMotion::keyframe);
  return found == motions.end() || found->keyframe != keyframe ? nullptr : &found->T_new_old;
}

}  // namespace povslam
