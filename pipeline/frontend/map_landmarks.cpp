// Landmarks and the sightings that join them to keyframes.
#include <algorithm>

#include "pipeline/base/expects.hpp"
#include "pipeline/frontend/map.hpp"

namespace povslam {

std::int32_t Map::free_landmark_slot() {
  if (!free_landmarks_.empty()) {
    const std::int32_t slot = free_landmarks_.back();
    free_landmarks_.pop_back();
    return slot;
  }
  if (landmarks_.size() == static_cast<std::size_t>(options_.max_landmarks)) return kNone;
  landmarks_.emplace_back();
  return static_cast<std::int32_t>(landmarks_.size()) - 1;
}

std::int32_t Map::create_landmark(std::int32_t keyframe_slot, int feature, const Eigen::Vector3d& p_world) {
  const std::int32_t slot = free_landmark_slot();
  if (slot == kNone) return kNone;
  Landmark& point = landmark(slot);
  const std::uint32_t generation = point.generation + 1;
  point = Landmark{};
  point.generation = generation;
  point.alive = true;
  point.id = next_landmark_id_++;
  point.p_world = p_world;
  point.born_keyframe = keyframe(keyframe_slot).id;
  point.anchor = keyframe_slot;
  point.visible = point.found = 1;
  ++num_landmarks_;
  add_sighting(slot, keyframe_slot, feature);
  refresh_landmark(slot);
  return slot;
}

// The only place that writes what a keyframe's feature shows.
void Map::join(const LandmarkSighting& sighting, std::int32_t landmark_slot) {
  Keyframe& kf = keyframe(sighting.keyframe);
  kf.landmark[static_cast<std::size_t>(sighting.feature)] = landmark_slot;
  ++kf.joined;
}

void Map::remove_landmark(std::int32_t slot) {
  Landmark& point = landmark(slot);
  EXPECTS(point.alive);
  for (int s = 0; s < point.num_sightings; ++s) {
    join(point.sightings[static_cast<std::size_t>(s)], kNone);
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
    join(gone, kNone);
    std::move(point.sightings.begin() + 2, point.sightings.end(), point.sightings.begin() + 1);
    --point.num_sightings;
    if (point.anchor == gone.keyframe) point.anchor = point.sightings[0].keyframe;
  }
  point.sightings[static_cast<std::size_t>(point.num_sightings++)] = {keyframe_slot, feature};
  join({keyframe_slot, feature}, landmark_slot);
  return true;
}

void Map::remove_sighting(std::int32_t landmark_slot, std::int32_t keyframe_slot) {
  Landmark& point = landmark(landmark_slot);
  for (int s = 0; s < point.num_sightings; ++s) {
    const LandmarkSighting sighting = point.sightings[static_cast<std::size_t>(s)];
    if (sighting.keyframe != keyframe_slot) continue;
    join(sighting, kNone);
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

}  // namespace povslam
