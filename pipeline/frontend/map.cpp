#include "pipeline/frontend/map.hpp"

#include <algorithm>
#include <utility>

#include "pipeline/base/expects.hpp"

namespace povslam {

Map::Map(int max_features, const MapOptions& options, std::vector<float> level_scales)
    : max_features_(max_features),
      options_(options),
      level_scales_(std::move(level_scales)),
      slot_of_id_(static_cast<std::size_t>(options.max_keyframes)) {
  EXPECTS(max_features > 0 && options.max_keyframes >= 4 && options.max_landmarks >= 100);
  const std::size_t slots = static_cast<std::size_t>(options.max_keyframes);
  const std::size_t entries = slots * static_cast<std::size_t>(max_features);
  keyframes_.reserve(slots);
  free_keyframes_.reserve(slots);
  landmarks_.reserve(static_cast<std::size_t>(options.max_landmarks));
  free_landmarks_.reserve(static_cast<std::size_t>(options.max_landmarks));
  ghosts_.reserve(kRememberedIds);
  floats_ = std::make_unique_for_overwrite<float[]>(5 * entries);
  levels_ = std::make_unique_for_overwrite<std::uint8_t[]>(entries);
  descriptors_ = std::make_unique_for_overwrite<Descriptor[]>(entries);
  patches_ = std::make_unique_for_overwrite<Patch[]>(static_cast<std::size_t>(options.max_landmarks));
  words_ = std::make_unique_for_overwrite<std::uint32_t[]>(entries);
  landmark_of_ = std::make_unique_for_overwrite<std::int32_t[]>(entries);
}

std::int32_t Map::free_keyframe_slot() {
  if (!free_keyframes_.empty()) {
    const std::int32_t slot = free_keyframes_.back();
    free_keyframes_.pop_back();
    return slot;
  }
  if (keyframes_.size() < static_cast<std::size_t>(options_.max_keyframes)) {
    keyframes_.emplace_back();
    return static_cast<std::int32_t>(keyframes_.size()) - 1;
  }
  // Full: the keyframe longest out of use goes (mark is renewed whenever a keyframe is part of the local map), of
  // several the first made; but never the one the world hangs on.
  const auto longest_unused = [](const Keyframe& a, const Keyframe& b) {
    const bool a_is_root = a.parent_id < 0, b_is_root = b.parent_id < 0;
    if (a_is_root != b_is_root) return b_is_root;
    return a.mark != b.mark ? a.mark < b.mark : a.id < b.id;
  };
  const auto oldest =
      static_cast<std::int32_t>(std::ranges::min_element(keyframes_, longest_unused) - keyframes_.begin());
  remove_keyframe(oldest);
  free_keyframes_.pop_back();
  return oldest;
}

std::int32_t Map::insert_keyframe(const Frame& frame, const Rigid3& T_world_camera, const Matrix6d& covariance,
                                  std::int64_t parent_id) {
  const std::int32_t slot = free_keyframe_slot();
  const std::size_t n = static_cast<std::size_t>(frame.size());
  Keyframe& kf = take_slot(slot, n);
  kf.id = next_id_++;
  kf.frame_index = frame.index;
  kf.stamp = frame.stamp;
  kf.T_world_camera = T_world_camera;
  kf.covariance = covariance;
  kf.parent_id = parent_id;
  std::copy_n(frame.x.begin(), n, kf.x.begin());
  std::copy_n(frame.y.begin(), n, kf.y.begin());
  std::copy_n(frame.inverse_depth.begin(), n, kf.inverse_depth.begin());
  std::copy_n(frame.sigma_inverse_depth.begin(), n, kf.sigma_inverse_depth.begin());
  std::copy_n(frame.sigma_px.begin(), n, kf.sigma_px.begin());
  std::copy_n(frame.features.level.begin(), n, kf.level.begin());
  std::copy_n(frame.features.descriptor.begin(), n, kf.descriptor.begin());
  std::fill(kf.word.begin(), kf.word.end(), 0U);
  if (ghosts_.size() < kRememberedIds) ghosts_.emplace_back();
  slot_of_id_.insert(kf.id, slot);
  ++num_keyframes_;
  return slot;
}

Keyframe& Map::take_slot(std::int32_t slot, std::size_t n) {
  EXPECTS(n <= static_cast<std::size_t>(max_features_));
  const std::size_t first = static_cast<std::size_t>(slot) * static_cast<std::size_t>(max_features_);
  Keyframe& kf = keyframe(slot);
  const std::uint32_t joined = kf.joined;
  kf = Keyframe{};
  kf.alive = true;
  kf.mark = mark_;
  kf.joined = joined + 1;
  float* floats = floats_.get() + 5 * first;
  kf.x = {floats, n};
  kf.y = {floats + max_features_, n};
  kf.inverse_depth = {floats + 2 * max_features_, n};
  kf.sigma_inverse_depth = {floats + 3 * max_features_, n};
  kf.sigma_px = {floats + 4 * max_features_, n};
  kf.level = {levels_.get() + first, n};
  kf.descriptor = {descriptors_.get() + first, n};
  kf.word = {words_.get() + first, n};
  kf.landmark = {landmark_of_.get() + first, n};
  std::fill(kf.landmark.begin(), kf.landmark.end(), kNone);
  return kf;
}

std::int32_t Map::find_keyframe(std::int64_t id) const {
  return slot_of_id_.find(id);
}

std::optional<Rigid3> Map::keyframe_pose(std::int64_t id) const {
  Rigid3 T_parent_camera;
  for (int hops = 0; hops < 4096; ++hops) {
    const std::int32_t slot = find_keyframe(id);
    if (slot != kNone) return keyframe(slot).T_world_camera * T_parent_camera;
    if (id < first_id_ || id >= next_id_) return std::nullopt;
    const Ghost& gone = ghost(id);
    if (gone.id != id) return std::nullopt;
    T_parent_camera = gone.T_parent_camera * T_parent_camera;
    id = gone.parent_id;
  }
  return std::nullopt;
}

void Map::leave_ghost(const Keyframe& kf, std::int64_t heir_id) {
  const auto T_world_heir = keyframe_pose(heir_id);
  if (!T_world_heir || kf.id < first_id_) return;  // of an earlier session: nobody holds a pose against it
  ghost(kf.id) = {kf.id, heir_id, T_world_heir->inverse() * kf.T_world_camera};
}

void Map::remove_keyframe(std::int32_t slot, std::int32_t heir) {
  Keyframe& kf = keyframe(slot);
  EXPECTS(kf.alive);
  kf.alive = false;  // so that it does not become its own heir, through an older ghost
  slot_of_id_.erase(kf.id);
  const std::int64_t next_id = kf.num_covisible > 0 ? keyframe(kf.covisible[0].keyframe).id : kf.parent_id;
  leave_ghost(kf, heir != kNone ? keyframe(heir).id : next_id);
  for (const std::int32_t seen : kf.landmark) {
    if (seen != kNone) remove_sighting(seen, slot);
  }
  drop_covisibility(slot);
  --num_keyframes_;
  free_keyframes_.push_back(slot);
}

}  // namespace povslam
