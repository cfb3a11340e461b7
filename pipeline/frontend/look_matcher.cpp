#include "pipeline/frontend/look_matcher.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/frontend/match.hpp"

namespace povslam {

namespace {
constexpr std::size_t kMatchedKeyframes = 2;  // whose landmarks are compared
constexpr double kUniqueRatio = 0.85;         // nearest look against the runner-up elsewhere in the image
constexpr float kElsewherePx = 8.0F;          // a corner is found on several levels: that is no runner-up
constexpr double kElsewhereM = 0.3;
}  // namespace

LookMatcher::LookMatcher(const FrontendOptions& options) {
  const std::size_t features = static_cast<std::size_t>(options.orb.num_features);
  marked_.resize(static_cast<std::size_t>(options.map.max_landmarks));
  landmarks_.reserve(kMaxLandmarks);
  taken_by_.resize(features);
  taken_distance_.resize(features);
  doubled_by_.resize(features);
  pairs_.reserve(features);
  doubles_.reserve(features);
}

void LookMatcher::gather(const Map& map, std::span<const std::int32_t> place) {
  ++mark_;
  landmarks_.clear();
  num_matched_ = 0;
  for (std::size_t k = 0; k < place.size(); ++k) {
    for (const std::int32_t slot : map.keyframe(place[k]).landmark) {
      if (slot == kNone || marked_[static_cast<std::size_t>(slot)] == mark_ || !map.believed(slot)) continue;
      if (landmarks_.size() == kMaxLandmarks) return;
      marked_[static_cast<std::size_t>(slot)] = mark_;
      landmarks_.push_back(slot);
      if (k < kMatchedKeyframes && landmarks_.size() <= kMaxMatched) num_matched_ = landmarks_.size();
    }
  }
}

void LookMatcher::match(const Map& map, std::span<const std::int32_t> place, const FeatureView& view) {
  gather(map, place);
  std::fill_n(taken_by_.begin(), view.size(), kNone);
  std::fill_n(taken_distance_.begin(), view.size(), 257);
  std::fill_n(doubled_by_.begin(), view.size(), kNone);
  for (std::size_t l = 0; l < num_matched_; ++l) {
    const Descriptor& look = map.landmark(landmarks_[l]).descriptor;
    int distance = 257, elsewhere = 257;
    std::size_t nearest = 0;
    for (std::size_t f = 0; f < view.size(); ++f) {
      const int d = hamming_distance(look, view.descriptor[f]);
      if (d >= elsewhere) continue;
      const bool same_spot = distance < 257 && std::abs(view.x[f] - view.x[nearest]) < kElsewherePx &&
                             std::abs(view.y[f] - view.y[nearest]) < kElsewherePx;
      if (d < distance) {
        if (!same_spot) elsewhere = distance;
        distance = d;
        nearest = f;
      } else if (!same_spot) {
        elsewhere = d;
      }
    }
    if (distance > kMaxDistanceFar || distance > kUniqueRatio * elsewhere) continue;
    take(map, nearest, landmarks_[l], distance);
  }
  pairs_.clear();
  doubles_.clear();
  for (std::size_t f = 0; f < view.size(); ++f) {
    if (taken_by_[f] != kNone) pairs_.push_back({static_cast<std::int32_t>(f), taken_by_[f]});
    if (doubled_by_[f] != kNone) doubles_.push_back({static_cast<std::int32_t>(f), doubled_by_[f]});
  }
}

// The feature shows the landmark that it resembles most; one that stands elsewhere and looks the same is remembered.
void LookMatcher::take(const Map& map, std::size_t feature, std::int32_t landmark, int distance) {
  std::int32_t& holder = taken_by_[feature];
  const bool closer = distance < taken_distance_[feature];
  const std::int32_t other = closer ? holder : landmark;
  if (closer) {
    holder = landmark;
    taken_distance_[feature] = distance;
  }
  if (other != kNone && (map.landmark(other).p_world - map.landmark(holder).p_world).norm() > kElsewhereM) {
    doubled_by_[feature] = other;
  }
}

}  // namespace povslam
