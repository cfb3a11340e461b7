#include "pipeline/frontend/match.hpp"

#include <algorithm>
#include <cmath>

namespace povslam {

Matcher::Matcher(int max_features)
    : tag_(static_cast<std::size_t>(max_features), kNone), distance_(static_cast<std::size_t>(max_features), 257) {}

void Matcher::start(const Frame& frame) {
  std::fill_n(tag_.begin(), frame.size(), kNone);
  std::fill_n(distance_.begin(), frame.size(), std::int16_t{257});
  count_ = 0;
}

int Matcher::match(const Frame& frame, const MatchCandidate& c, int max_distance, double ratio) {
  int best = -1, best_distance = 257, best_level = -1;
  int second_distance = 257, second_level = -1;
  frame.grid.for_each_near(c.u_px, c.v_px, c.radius_px, [&](std::int32_t i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const int level = frame.features.level[k];
    if (level < c.min_level || level > c.max_level) return;
    if (std::abs(frame.x[k] - c.u_px) > c.radius_px || std::abs(frame.y[k] - c.v_px) > c.radius_px) return;
    const int distance = hamming_distance(*c.descriptor, frame.features.descriptor[k]);
    if (distance < best_distance) {
      second_distance = best_distance, second_level = best_level;
      best = i, best_distance = distance, best_level = level;
    } else if (distance < second_distance) {
      second_distance = distance, second_level = level;
    }
  });
  if (best < 0 || best_distance > max_distance) return -1;
  if (best_level == second_level && best_distance > ratio * second_distance) return -1;
  const std::size_t k = static_cast<std::size_t>(best);
  if (distance_[k] <= best_distance) return -1;
  if (tag_[k] == kNone) ++count_;
  tag_[k] = c.tag;
  distance_[k] = static_cast<std::int16_t>(best_distance);
  return best;
}

void Matcher::hold() {
  for (std::size_t k = 0; k < tag_.size(); ++k) {
    if (tag_[k] != kNone) distance_[k] = -1;
  }
}

void Matcher::release(int feature) {
  const std::size_t k = static_cast<std::size_t>(feature);
  if (tag_[k] == kNone) return;
  tag_[k] = kNone;
  distance_[k] = 257;
  --count_;
}

}  // namespace povslam
