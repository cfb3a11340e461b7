// Finding, for points with a predicted place in the image, the feature that shows them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/frontend/frame.hpp"

namespace povslam {

// Bits of 256 in which two looks at one point may differ.
inline constexpr int kMaxDistance = 90;        // prediction known
inline constexpr int kMaxDistanceFar = 60;     // prediction poor or none
inline constexpr double kNearestRatio = 0.85;  // best against runner-up of the same level

struct MatchCandidate {
  float u_px = 0.0F, v_px = 0.0F;  // predicted, rectified
  float radius_px = 0.0F;
  std::int8_t min_level = 0, max_level = 0;
  const Descriptor* descriptor = nullptr;
  std::int32_t tag = -1;  // the caller's name for the point
};

// feature -> tag of the point it shows. One point per feature: the closer look wins.
class Matcher {
 public:
  explicit Matcher(int max_features);

  void start(const Frame& frame);  // forgets all matches
  // Best feature for the candidate, if any is good enough. Features already taken by a closer look are left alone.
  // Returns the feature, or -1.
  int match(const Frame& frame, const MatchCandidate& candidate, int max_distance, double ratio);
  void release(int feature);
  void hold();  // what is matched by now stays, however close others look

  std::int32_t tag_of(int feature) const { return tag_[static_cast<std::size_t>(feature)]; }
  int count() const { return count_; }

 private:
  std::vector<std::int32_t> tag_;
  std::vector<std::int16_t> distance_;
  int count_ = 0;
};

}  // namespace povslam
