// The pixel pairs BRIEF compares (orb_pairs.hpp), turned to the feature's angle in steps of 6 degrees (Rublee et al.,
// ICCV 2011, section 4.1), and the round patch of the intensity centroid (section 3.2).
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/frontend/kernels/kernels.hpp"

namespace povslam {

PatchMask round_patch();

// atan2 from basic operations only: the same bits on every machine. Error below 1e-6 rad.
float steady_atan2(float y, float x);

class BriefPattern {
 public:
  static constexpr int kAngles = 60;

  // stride: bytes between rows of the images the offsets are for.
  explicit BriefPattern(std::int64_t stride);

  struct Offsets {
    const std::int32_t* first;
    const std::int32_t* second;
  };
  Offsets at_angle(float angle_rad) const;

 private:
  std::vector<std::int32_t> offsets_;  // per angle: kBriefBits first, then kBriefBits second
};

}  // namespace povslam
