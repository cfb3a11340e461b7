#include "pipeline/frontend/map_loader.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace povslam {

namespace {

constexpr std::int64_t kLongAgo = -(std::int64_t{1} << 40);                           // frames before this session
using SightingsOf = std::unordered_map<std::int64_t, std::vector<LandmarkSighting>>;  // by landmark id

template <class Row, class Id>
std::vector<const Row*> by_id(const std::vector<Row>& rows, Id id) {
  std::vector<const Row*> sorted;
  sorted.reserve(rows.size());
  for (const Row& row : rows) sorted.push_back(&row);
  std::sort(sorted.begin(), sorted.end(), [id](const Row* a, const Row* b) { return a->*id < b->*id; });
  return sorted;
}

}  // namespace

MapLoader::MapLoader(const MapContent& content, const PinholeCamera& camera, Map& map)
    : content_(content), camera_(camera), map_(map), made_by_(camera) {
  const MapMeta& meta = content.meta;
  if (meta.fx > 0.0 && meta.fy > 0.0) {
    made_by_.fx = meta.fx, made_by_.fy = meta.fy;
    made_by_.cx = meta.cx, made_by_.cy = meta.cy;
  }
  zoom_x_ = camera.fx / made_by_.fx;
  zoom_y_ = camera.fy / made_by_.fy;
  if (meta.level_scale > 1.0 && map.num_levels() > 1) {
    levels_ = std::log(meta.level_scale) / std::log(static_cast<double>(map.level_scale(1)));
  }
}

void MapLoader::load(const MapContent& content, const PinholeCamera& camera, Map& map) {
  EXPECTS(map.num_keyframes() == 0 && map.next_keyframe_id() == 0);
  MapLoader loader(content, camera, map);
  map.first_id_ = map.next_id_ = content.meta.next_keyframe;
  map.next_landmark_id_ = content.meta.next_landmark;
  std::unordered_map<std::int64_t, const KeyframeFeatures*> features;
  for (const KeyframeFeatures& seen : content.features) features[seen.keyframe] = &seen;
  for (const KeyframeRow* row : by_id(content.keyframes, &KeyframeRow::keyframe)) {
    const auto seen = features.find(row->keyframe);
    const bool full = map.num_keyframes() == map.options_.max_keyframes;
    if (seen == features.end() || full) continue;
    loader.add_keyframe(*row, *seen->second);
  }
  loader.add_landmarks();
  loader.add_looks();
  for (std::int32_t s = 0; s < map.keyframe_slots(); ++s) map.update_covisibility(s);
}

void MapLoader::add_keyframe(const KeyframeRow& row, const KeyframeFeatures& seen) {
  const std::int32_t slot = map_.free_keyframe_slot();
  const std::size_t n = std::min(seen.x.size(), static_cast<std::size_t>(map_.max_features_));
  Keyframe& kf = map_.take_slot(slot, n);
  kf.id = row.keyframe;
  kf.frame_index = kLongAgo;
  kf.stamp = seen.stamp;
  kf.T_world_camera = row.T_world_camera;
  kf.covariance = row.covariance;
  kf.parent_id = row.parent;
  for (std::size_t f = 0; f < n; ++f) {
    kf.x[f] = static_cast<float>(zoom_x_ * (static_cast<double>(seen.x[f]) - made_by_.cx) + camera_.cx);
    kf.y[f] = static_cast<float>(zoom_y_ * (static_cast<double>(seen.y[f]) - made_by_.cy) + camera_.cy);
    kf.sigma_px[f] = static_cast<float>(static_cast<double>(seen.sigma_px[f]) * zoom_x_);
    kf.level[f] = static_cast<std::uint8_t>(
        std::clamp(static_cast<int>(std::lround(seen.level[f] * levels_)), 0, map_.num_levels() - 1));
  }
  std::copy_n(seen.inverse_depth.begin(), n, kf.inverse_depth.begin());
  std::copy_n(seen.sigma_inverse_depth.begin(), n, kf.sigma_inverse_depth.begin());
  std::copy_n(seen.descriptor.begin(), n, kf.descriptor.begin());
  std::fill(kf.word.begin(), kf.word.end(), 0U);
  if (!seen.word.empty()) std::copy_n(seen.word.begin(), n, kf.word.begin());
  map_.slot_of_id_.insert(kf.id, slot);
  ++map_.num_keyframes_;
}

// A landmark comes back when its anchor did and still sees it.
void MapLoader::add_landmarks() {
  SightingsOf sightings;
  for (const KeyframeRow& row : content_.keyframes) {
    const std::int32_t slot = map_.find_keyframe(row.keyframe);
    if (slot == kNone) continue;
    const std::size_t n = std::min(row.landmark.size(), map_.keyframe(slot).landmark.size());
    for (std::size_t f = 0; f < n; ++f) {
      if (row.landmark[f] >= 0) sightings[row.landmark[f]].push_back({slot, static_cast<std::int32_t>(f)});
    }
  }
  for (const LandmarkRow* row : by_id(content_.landmarks, &LandmarkRow::landmark)) {
    const std::int32_t anchor = map_.find_keyframe(row->anchor);
    const auto seen = sightings.find(row->landmark);
    if (anchor == kNone || seen == sightings.end()) continue;
    std::vector<LandmarkSighting>& by = seen->second;
    std::sort(by.begin(), by.end(),
              [this](auto a, auto b) { return map_.keyframe(a.keyframe).id < map_.keyframe(b.keyframe).id; });
    const std::int32_t slot = map_.free_landmark_slot();
    if (slot == kNone) return;
    Landmark& point = map_.landmark(slot);
    const Rigid3& T_world_anchor = map_.keyframe(anchor).T_world_camera;
    point.alive = true;
    point.id = row->landmark;
    point.p_world = T_world_anchor * row->p_anchor;
    point.born_keyframe = row->born_keyframe;
    point.anchor = anchor;
    point.visible = row->visible;
    point.found = row->found;
    point.tangent_x = T_world_anchor.rotation.cast<float>() * row->tangent_x_anchor;
    point.tangent_y = T_world_anchor.rotation.cast<float>() * row->tangent_y_anchor;
    ++map_.num_landmarks_;
    for (const LandmarkSighting& sighting : by) {
      if (point.num_sightings < kMaxSightings) map_.add_sighting(slot, sighting.keyframe, sighting.feature);
    }
    map_.refresh_landmark(slot);
    if (!map_.sees(anchor, slot)) point.anchor = point.sightings[0].keyframe;
  }
}

void MapLoader::add_looks() {
  std::unordered_map<std::int64_t, const LandmarkLook*> looks;
  for (const LandmarkLook& look : content_.looks) looks[look.landmark] = &look;
  for (std::int32_t s = 0; s < map_.landmark_slots(); ++s) {
    const auto look = looks.find(map_.landmark(s).id);
    map_.landmark(s).has_patch = look != looks.end();
    if (look != looks.end()) map_.patch(s) = look->second->patch;
  }
}

}  // namespace povslam
