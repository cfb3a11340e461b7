#include "pipeline/frontend/map_journal.hpp"

#include <algorithm>
#include <unordered_set>

namespace povslam {

namespace {
constexpr std::int32_t kLandmarksPerSlice = 4000;
// Smaller changes wait for larger ones: they are below what the map knows.
constexpr double kLandmarkMovedM = 0.001, kLandmarkMovedShare = 0.001;  // and share of its distance
constexpr double kKeyframeMovedM = 0.0005, kKeyframeTurnedRad = 0.0002;
}  // namespace

MapJournal::MapJournal(const PinholeCamera& camera, const MapOptions& options)
    : camera_(camera),
      period_(from_seconds(options.change_period_s)),
      keyframes_(static_cast<std::size_t>(options.max_keyframes)) {
  landmarks_.reserve(static_cast<std::size_t>(options.max_landmarks));
}

void MapJournal::assume_written(const Map& map, const MapContent& content) {
  look_at_landmarks(map, 0, map.landmark_slots());
  look_at_keyframes(map);
  change_.clear();
  if (static_cast<std::size_t>(map.num_landmarks()) == landmarks_.capacity()) return;  // what is missing had no room
  std::unordered_set<std::int64_t> there;
  for (const WrittenLandmark& written : landmarks_) there.insert(written.id);
  for (const LandmarkRow& row : content.landmarks) {
    const bool anchored = map.find_keyframe(row.anchor) != kNone;
    if (anchored && !there.contains(row.landmark)) change_.removed_landmarks.push_back(row.landmark);
  }
}

MapChange* MapJournal::advance(const Map& map, const MapMeta& meta, TimeNs now) {
  if (!started_) started_ = true, last_finished_ = now;
  if (out_) return nullptr;
  const std::int32_t last = std::min(cursor_ + kLandmarksPerSlice, map.landmark_slots());
  if (cursor_ < last) look_at_landmarks(map, cursor_, last);
  cursor_ = std::max(cursor_, last);
  if (cursor_ < map.landmark_slots() || now - last_finished_ < period_) return nullptr;
  last_finished_ = now;
  return finish(map, meta);
}

MapChange* MapJournal::collect(const Map& map, const MapMeta& meta) {
  if (out_) return nullptr;
  look_at_landmarks(map, 0, map.landmark_slots());
  return finish(map, meta);
}

MapChange* MapJournal::finish(const Map& map, const MapMeta& meta) {
  cursor_ = 0;
  look_at_keyframes(map);
  if (change_.empty()) return nullptr;
  change_.meta = meta;
  change_.meta.next_keyframe = map.next_keyframe_id();
  change_.meta.next_landmark = map.next_landmark_id();
  change_.meta.fx = camera_.fx, change_.meta.fy = camera_.fy;
  change_.meta.cx = camera_.cx, change_.meta.cy = camera_.cy;
  change_.meta.level_scale = map.num_levels() > 1 ? static_cast<double>(map.level_scale(1)) : 2.0;
  out_ = true;
  return &change_;
}

void MapJournal::give_back(MapChange* change) {
  EXPECTS(change == &change_ && out_);
  change_.clear();
  out_ = false;
}

void MapJournal::look_at_landmarks(const Map& map, std::int32_t first, std::int32_t last) {
  if (landmarks_.size() < static_cast<std::size_t>(last)) landmarks_.resize(static_cast<std::size_t>(last));
  for (std::int32_t slot = first; slot < last; ++slot) look_at_landmark(map, slot);
}

void MapJournal::look_at_landmark(const Map& map, std::int32_t slot) {
  const Landmark& point = map.landmark(slot);
  WrittenLandmark& written = landmarks_[static_cast<std::size_t>(slot)];
  const bool same = point.alive && written.id == point.id;
  if (written.id >= 0 && !same) {
    change_.removed_landmarks.push_back(written.id);
    written = {};
  }
  if (!point.alive) return;
  const Keyframe& anchor = map.keyframe(point.anchor);
  const Eigen::Vector3d p_anchor = anchor.T_world_camera.inverse() * point.p_world;
  const double moved = (p_anchor - written.p_anchor.cast<double>()).norm();
  if (same && written.anchor == anchor.id && moved <= kLandmarkMovedM + kLandmarkMovedShare * p_anchor.norm()) return;
  const Eigen::Quaternionf R_anchor_world = anchor.T_world_camera.rotation.conjugate().cast<float>();
  change_.landmarks.push_back({point.id, anchor.id, p_anchor, point.born_keyframe, point.visible, point.found,
                               point.has_patch, R_anchor_world * point.tangent_x, R_anchor_world * point.tangent_y});
  if (!same && point.has_patch) change_.looks.push_back({point.id, map.patch(slot)});
  written = {point.id, anchor.id, p_anchor.cast<float>()};
}

void MapJournal::look_at_keyframes(const Map& map) {
  for (std::int32_t slot = 0; slot < map.keyframe_slots(); ++slot) {
    const Keyframe& kf = map.keyframe(slot);
    WrittenKeyframe& written = keyframes_[static_cast<std::size_t>(slot)];
    const bool same = kf.alive && written.id == kf.id;
    if (written.id >= 0 && !same) {
      change_.removed_keyframes.push_back(written.id);
      written = {};
    }
    if (!kf.alive) continue;
    const Rigid3 moved = written.T_world_camera.inverse() * kf.T_world_camera;
    const bool stays = moved.translation.norm() <= kKeyframeMovedM && rotation_angle_rad(moved) <= kKeyframeTurnedRad;
    if (same && stays && written.joined == kf.joined && written.parent_id == kf.parent_id) continue;
    write_keyframe(map, kf, written);
  }
}

void MapJournal::write_keyframe(const Map& map, const Keyframe& kf, WrittenKeyframe& written) {
  if (written.id != kf.id) {
    KeyframeFeatures& seen = change_.features.emplace_back();
    seen.keyframe = kf.id;
    seen.stamp = kf.stamp;
    seen.x.assign(kf.x.begin(), kf.x.end());
    seen.y.assign(kf.y.begin(), kf.y.end());
    seen.sigma_px.assign(kf.sigma_px.begin(), kf.sigma_px.end());
    seen.inverse_depth.assign(kf.inverse_depth.begin(), kf.inverse_depth.end());
    seen.sigma_inverse_depth.assign(kf.sigma_inverse_depth.begin(), kf.sigma_inverse_depth.end());
    seen.level.assign(kf.level.begin(), kf.level.end());
    seen.descriptor.assign(kf.descriptor.begin(), kf.descriptor.end());
    seen.word.assign(kf.word.begin(), kf.word.end());
  }
  KeyframeRow& row = change_.keyframes.emplace_back();
  row.keyframe = kf.id;
  row.parent = kf.parent_id;
  row.T_world_camera = kf.T_world_camera;
  row.covariance = kf.covariance;
  row.landmark.reserve(kf.landmark.size());
  for (const std::int32_t seen : kf.landmark) row.landmark.push_back(seen == kNone ? -1 : map.landmark(seen).id);
  written = {kf.id, kf.parent_id, kf.T_world_camera, kf.joined};
}

}  // namespace povslam
