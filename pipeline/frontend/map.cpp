#include "pipeline/frontend/map.hpp"

#include <algorithm>
#include <utility>

#include "pipeline/base/expects.hpp"

namespace povslam {

namespace {
constexpr std::size_t kRememberedIds = 1 << 17;  // removed keyframes whose pose can still be asked for
std::size_t id_slot(std::int64_t id) {
  return static_cast<std::size_t>(id) & (kRememberedIds - 1);
}
}  // namespace

Map::Map(int max_features, const MapOptions& options, std::vector<float> level_scales)
    : max_features_(max_features), options_(options), level_scales_(std::move(level_scales)) {
  EXPECTS(max_features > 0 && options.max_keyframes >= 4 && options.max_landmarks >= 100);
  const std::size_t slots = static_cast<std::size_t>(options.max_keyframes);
  const std::size_t entries = slots * static_cast<std::size_t>(max_features);
  keyframes_.reserve(slots);
  free_keyframes_.reserve(slots);
  landmarks_.reserve(static_cast<std::size_t>(options.max_landmarks));
  free_landmarks_.reserve(static_cast<std::size_t>(options.max_landmarks));
  ghosts_.reserve(kRememberedIds);
  slot_of_id_.reserve(kRememberedIds);
  floats_ = std::make_unique_for_overwrite<float[]>(5 * entries);
  levels_ = std::make_unique_for_overwrite<std::uint8_t[]>(entries);
  descriptors_ = std::make_unique_for_overwrite<Descriptor[]>(entries);
  patches_ = std::make_unique_for_overwrite<Patch[]>(static_cast<std::size_t>(options.max_landmarks));
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
  // several the first made.
  const auto longest_unused = [](const Keyframe& a, const Keyframe& b) {
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
  const std::size_t first = static_cast<std::size_t>(slot) * static_cast<std::size_t>(max_features_);
  Keyframe& kf = keyframe(slot);
  kf = Keyframe{};
  kf.alive = true;
  kf.id = next_id_++;
  kf.frame_index = frame.index;
  kf.stamp = frame.stamp;
  kf.T_world_camera = T_world_camera;
  kf.covariance = covariance;
  kf.parent_id = parent_id;
  kf.mark = mark_;
  float* floats = floats_.get() + 5 * first;
  kf.x = {floats, n};
  kf.y = {floats + max_features_, n};
  kf.inverse_depth = {floats + 2 * max_features_, n};
  kf.sigma_inverse_depth = {floats + 3 * max_features_, n};
  kf.sigma_px = {floats + 4 * max_features_, n};
  kf.level = {levels_.get() + first, n};
  kf.descriptor = {descriptors_.get() + first, n};
  kf.landmark = {landmark_of_.get() + first, n};
  std::copy_n(frame.x.begin(), n, kf.x.begin());
  std::copy_n(frame.y.begin(), n, kf.y.begin());
  std::copy_n(frame.inverse_depth.begin(), n, kf.inverse_depth.begin());
  std::copy_n(frame.sigma_inverse_depth.begin(), n, kf.sigma_inverse_depth.begin());
  std::copy_n(frame.sigma_px.begin(), n, kf.sigma_px.begin());
  std::copy_n(frame.features.level.begin(), n, kf.level.begin());
  std::copy_n(frame.features.descriptor.begin(), n, kf.descriptor.begin());
  std::fill(kf.landmark.begin(), kf.landmark.end(), kNone);
  if (slot_of_id_.size() < kRememberedIds) {
    slot_of_id_.push_back(slot);
    ghosts_.emplace_back();
  } else {
    slot_of_id_[id_slot(kf.id)] = slot;
  }
  ++num_keyframes_;
  return slot;
}

std::int32_t Map::find_keyframe(std::int64_t id) const {
  if (id < 0 || id >= next_id_ || id < next_id_ - static_cast<std::int64_t>(kRememberedIds)) return kNone;
  const std::int32_t slot = slot_of_id_[id_slot(id)];
  return keyframe(slot).alive && keyframe(slot).id == id ? slot : kNone;
}

std::optional<Rigid3> Map::keyframe_pose(std::int64_t id) const {
  Rigid3 T_parent_camera;
  for (int hops = 0; hops < 4096; ++hops) {
    const std::int32_t slot = find_keyframe(id);
    if (slot != kNone) return keyframe(slot).T_world_camera * T_parent_camera;
    if (id < 0 || id >= next_id_) return std::nullopt;
    const Ghost& ghost = ghosts_[id_slot(id)];
    if (ghost.id != id) return std::nullopt;
    T_parent_camera = ghost.T_parent_camera * T_parent_camera;
    id = ghost.parent_id;
  }
  return std::nullopt;
}

void Map::leave_ghost(const Keyframe& kf, std::int64_t heir_id) {
  const auto T_world_heir = keyframe_pose(heir_id);
  if (!T_world_heir) return;
  Ghost& ghost = ghosts_[id_slot(kf.id)];
  ghost.id = kf.id;
  ghost.parent_id = heir_id;
  ghost.T_parent_camera = T_world_heir->inverse() * kf.T_world_camera;
}

void Map::remove_keyframe(std::int32_t slot, std::int32_t heir) {
  Keyframe& kf = keyframe(slot);
  EXPECTS(kf.alive);
  kf.alive = false;  // so that it does not become its own heir, through an older ghost
  const std::int64_t next_id = kf.num_covisible > 0 ? keyframe(kf.covisible[0].keyframe).id : kf.parent_id;
  leave_ghost(kf, heir != kNone ? keyframe(heir).id : next_id);
  for (const std::int32_t seen : kf.landmark) {
    if (seen != kNone) remove_sighting(seen, slot);
  }
  drop_covisibility(slot);
  --num_keyframes_;
  free_keyframes_.push_back(slot);
}

std::int32_t Map::create_landmark(std::int32_t keyframe_slot, int feature, const Eigen::Vector3d& p_world) {
  std::int32_t slot = kNone;
  if (!free_landmarks_.empty()) {
    slot = free_landmarks_.back();
    free_landmarks_.pop_back();
  } else if (landmarks_.size() < static_cast<std::size_t>(options_.max_landmarks)) {
    landmarks_.emplace_back();
    slot = static_cast<std::int32_t>(landmarks_.size()) - 1;
  } else {
    return kNone;
  }
  Landmark& point = landmark(slot);
  const std::uint32_t generation = point.generation + 1;
  point = Landmark{};
  point.generation = generation;
  point.alive = true;
  point.p_world = p_world;
  point.born_keyframe = keyframe(keyframe_slot).id;
  point.anchor = keyframe_slot;
  point.visible = point.found = 1;
  ++num_landmarks_;
  add_sighting(slot, keyframe_slot, feature);
  refresh_landmark(slot);
  return slot;
}

void Map::remove_landmark(std::int32_t slot) {
  Landmark& point = landmark(slot);
  EXPECTS(point.alive);
  for (int s = 0; s < point.num_sightings; ++s) {
    const LandmarkSighting& sighting = point.sightings[static_cast<std::size_t>(s)];
    keyframe(sighting.keyframe).landmark[static_cast<std::size_t>(sighting.feature)] = kNone;
  }
  point.num_sightings = 0;
  point.alive = false;
  ++point.generation;
  --num_landmarks_;
  free_landmarks_.push_back(slot);
}

bool Map::sees(std::int32_t keyframe_slot, std::int32_t landmark_slot) const {
  const Landmark& point = landmark(landmark_slot);
  for (int s = 0; s < point.num_sightings; ++s) {
    if (point.sightings[static_cast<std::size_t>(s)].keyframe == keyframe_slot) return true;
  }
  return false;
}

bool Map::add_sighting(std::int32_t landmark_slot, std::int32_t keyframe_slot, int feature) {
  Landmark& point = landmark(landmark_slot);
  EXPECTS(point.alive && keyframe(keyframe_slot).landmark[static_cast<std::size_t>(feature)] == kNone);
  if (sees(keyframe_slot, landmark_slot)) return false;
  if (point.num_sightings == kMaxSightings) {
    const LandmarkSighting gone = point.sightings[1];
    keyframe(gone.keyframe).landmark[static_cast<std::size_t>(gone.feature)] = kNone;
    std::move(point.sightings.begin() + 2, point.sightings.end(), point.sightings.begin() + 1);
    --point.num_sightings;
    if (point.anchor == gone.keyframe) point.anchor = point.sightings[0].keyframe;
  }
  point.sightings[static_cast<std::size_t>(point.num_sightings++)] = {keyframe_slot, feature};
  keyframe(keyframe_slot).landmark[static_cast<std::size_t>(feature)] = landmark_slot;
  return true;
}

void Map::remove_sighting(std::int32_t landmark_slot, std::int32_t keyframe_slot) {
  Landmark& point = landmark(landmark_slot);
  for (int s = 0; s < point.num_sightings; ++s) {
    const LandmarkSighting sighting = point.sightings[static_cast<std::size_t>(s)];
    if (sighting.keyframe != keyframe_slot) continue;
    keyframe(keyframe_slot).landmark[static_cast<std::size_t>(sighting.feature)] = kNone;
    std::move(point.sightings.begin() + s + 1, point.sightings.begin() + point.num_sightings,
              point.sightings.begin() + s);
    --point.num_sightings;
    break;
  }
  if (point.num_sightings == 0) {
    remove_landmark(landmark_slot);
  } else if (point.anchor == keyframe_slot) {
    point.anchor = point.sightings[0].keyframe;
  }
}

void Map::merge_landmarks(std::int32_t keep, std::int32_t drop) {
  if (keep == drop) return;
  Landmark& from = landmark(drop);
  const int count = from.num_sightings;
  std::array<LandmarkSighting, kMaxSightings> sightings = from.sightings;
  landmark(keep).visible += from.visible;
  landmark(keep).found += from.found;
  remove_landmark(drop);
  for (int s = 0; s < count; ++s) {
    const LandmarkSighting& sighting = sightings[static_cast<std::size_t>(s)];
    add_sighting(keep, sighting.keyframe, sighting.feature);
  }
  refresh_landmark(keep);
}

void Map::refresh_landmark(std::int32_t slot) {
  Landmark& point = landmark(slot);
  const int n = point.num_sightings;
  if (n == 0) return;
  const auto descriptor_of = [this, &point](int s) -> const Descriptor& {
    const LandmarkSighting& sighting = point.sightings[static_cast<std::size_t>(s)];
    return keyframe(sighting.keyframe).descriptor[static_cast<std::size_t>(sighting.feature)];
  };
  // The medoid of the newest sightings: a look that all others resemble. Bounded work.
  constexpr int kCompared = 9;
  const int begin = std::max(0, n - kCompared);
  int best = n - 1, best_sum = 1 << 30;
  for (int a = begin; a < n; ++a) {
    int sum = 0;
    for (int b = begin; b < n; ++b) sum += hamming_distance(descriptor_of(a), descriptor_of(b));
    if (sum < best_sum) best_sum = sum, best = a;
  }
  point.descriptor = descriptor_of(best);
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  for (int s = 0; s < n; ++s) {
    const Keyframe& kf = keyframe(point.sightings[static_cast<std::size_t>(s)].keyframe);
    direction += (kf.T_world_camera.translation - point.p_world).normalized();
  }
  point.toward_camera = direction.normalized();
  const LandmarkSighting& chosen = point.sightings[static_cast<std::size_t>(best)];
  const Keyframe& kf = keyframe(chosen.keyframe);
  point.reference_level = kf.level[static_cast<std::size_t>(chosen.feature)];
  point.reference_distance_m = static_cast<float>((kf.T_world_camera.translation - point.p_world).norm());
}

void Map::drop_covisibility(std::int32_t slot) {
  Keyframe& kf = keyframe(slot);
  for (int i = 0; i < kf.num_covisible; ++i) {
    link_covisible(kf.covisible[static_cast<std::size_t>(i)].keyframe, slot, 0);
  }
  kf.num_covisible = 0;
  // Lists are bounded, so a link may be one-sided: look at every other keyframe too.
  for (std::int32_t other = 0; other < keyframe_slots(); ++other) {
    if (keyframe(other).alive && other != slot) link_covisible(other, slot, 0);
  }
}

// Sets, moves or (weight 0) removes `other` in the list of `slot`, kept heaviest first.
void Map::link_covisible(std::int32_t slot, std::int32_t other, std::int32_t weight) {
  Keyframe& kf = keyframe(slot);
  const auto begin = kf.covisible.begin();
  const auto end = begin + kf.num_covisible;
  const auto present = std::find_if(begin, end, [other](const Covisible& c) { return c.keyframe == other; });
  if (present != end) {
    std::move(present + 1, end, present);
    --kf.num_covisible;
  }
  if (weight <= 0) return;
  int place = kf.num_covisible;
  while (place > 0 && kf.covisible[static_cast<std::size_t>(place - 1)].weight < weight) --place;
  if (place >= kMaxCovisible) return;
  const int kept = std::min(kf.num_covisible, kMaxCovisible - 1);
  std::move_backward(begin + place, begin + kept, begin + kept + 1);
  kf.covisible[static_cast<std::size_t>(place)] = {other, weight};
  kf.num_covisible = kept + 1;
}

void Map::update_covisibility(std::int32_t slot) {
  constexpr std::int32_t kMinShared = 10;
  Keyframe& kf = keyframe(slot);
  for (Keyframe& other : keyframes_) other.votes = 0;
  for (const std::int32_t seen : kf.landmark) {
    if (seen == kNone) continue;
    const Landmark& point = landmark(seen);
    for (int s = 0; s < point.num_sightings; ++s) {
      ++keyframe(point.sightings[static_cast<std::size_t>(s)].keyframe).votes;
    }
  }
  for (std::int32_t other = 0; other < keyframe_slots(); ++other) {
    if (other == slot || !keyframe(other).alive) continue;
    const std::int32_t weight = keyframe(other).votes >= kMinShared ? keyframe(other).votes : 0;
    link_covisible(slot, other, weight);
    link_covisible(other, slot, weight);
  }
}

}  // namespace povslam
