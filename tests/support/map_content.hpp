// A map in memory, kept by its changes as a store keeps it on disk.
#pragma once

#include <algorithm>
#include <set>

#include "pipeline/frontend/map_rows.hpp"

namespace povslam {

namespace map_content_detail {
template <class Row>
void upsert(std::vector<Row>& rows, const std::vector<Row>& changed, std::int64_t Row::*id) {
  std::set<std::int64_t> ids;
  for (const Row& row : changed) ids.insert(row.*id);
  std::erase_if(rows, [&](const Row& row) { return ids.contains(row.*id); });
  rows.insert(rows.end(), changed.begin(), changed.end());
}
template <class Row>
void remove(std::vector<Row>& rows, const std::vector<std::int64_t>& gone, std::int64_t Row::*id) {
  const std::set<std::int64_t> ids(gone.begin(), gone.end());
  std::erase_if(rows, [&](const Row& row) { return ids.contains(row.*id); });
}
}  // namespace map_content_detail

inline void apply_change(MapContent& content, const MapChange& change) {
  using namespace map_content_detail;
  content.meta = change.meta;
  remove(content.features, change.removed_keyframes, &KeyframeFeatures::keyframe);
  remove(content.keyframes, change.removed_keyframes, &KeyframeRow::keyframe);
  remove(content.landmarks, change.removed_landmarks, &LandmarkRow::landmark);
  remove(content.looks, change.removed_landmarks, &LandmarkLook::landmark);
  upsert(content.features, change.features, &KeyframeFeatures::keyframe);
  upsert(content.keyframes, change.keyframes, &KeyframeRow::keyframe);
  upsert(content.landmarks, change.landmarks, &LandmarkRow::landmark);
  upsert(content.looks, change.looks, &LandmarkLook::landmark);
}

}  // namespace povslam
