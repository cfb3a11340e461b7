// Pairs a view's features with the landmarks of a place by their looks alone, without any prediction.
// No allocation after construction.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/frontend/feature_view.hpp"
#include "pipeline/frontend/map.hpp"

namespace povslam {

struct FeatureOfLandmark {
  std::int32_t feature = -1;   // of the view
  std::int32_t landmark = -1;  // slot
};

class LookMatcher {
 public:
  static constexpr std::size_t kMaxMatched = 1500;    // landmarks compared with all features
  static constexpr std::size_t kMaxLandmarks = 4000;  // of a place; more are not gathered

  explicit LookMatcher(const FrontendOptions& options);

  // place: slots of keyframes; landmarks of the first few are compared, all are gathered.
  void match(const Map& map, std::span<const std::int32_t> place, const FeatureView& view);

  std::span<const std::int32_t> landmarks() const { return landmarks_; }  // that the place's keyframes see
  std::span<const FeatureOfLandmark> pairs() const { return pairs_; }     // a feature at most once
  // Of the same features: landmarks that look the same and stand elsewhere.
  std::span<const FeatureOfLandmark> doubles() const { return doubles_; }

 private:
  void gather(const Map& map, std::span<const std::int32_t> place);
  void take(const Map& map, std::size_t feature, std::int32_t landmark, int distance);

  std::int64_t mark_ = 0;
  std::vector<std::int64_t> marked_;  // by landmark slot: last gathered in…
  std::vector<std::int32_t> landmarks_;
  std::size_t num_matched_ = 0;           // of landmarks_, the first
  std::vector<std::int32_t> taken_by_;    // by feature: the landmark that looks most like it…
  std::vector<int> taken_distance_;       // …in bits…
  std::vector<std::int32_t> doubled_by_;  // …and one that looks the same and stands elsewhere
  std::vector<FeatureOfLandmark> pairs_, doubles_;
};

}  // namespace povslam
