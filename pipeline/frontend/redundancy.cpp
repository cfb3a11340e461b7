#include "pipeline/frontend/redundancy.hpp"

#include <algorithm>

namespace povslam {

namespace {
constexpr int kEnoughSightings = 3;
constexpr int kKeyframeSample = 16;
constexpr int kLandmarkSample = 4;  // looked at for each one that goes
}  // namespace

double image_shift(const PinholeCamera& camera, const Rigid3& T_world_a, const Rigid3& T_world_b,
                   double inverse_depth_per_m) {
  const double moved_m = (T_world_a.translation - T_world_b.translation).norm();
  const double turned_rad = T_world_a.rotation.angularDistance(T_world_b.rotation);
  return camera.fx / camera.width * (turned_rad + moved_m * inverse_depth_per_m);
}

int landmarks_seen(const Keyframe& keyframe) {
  return static_cast<int>(std::ranges::count_if(keyframe.landmark, [](std::int32_t slot) { return slot != kNone; }));
}

KeyframeUse use_of(const Map& map, std::int32_t slot) {
  const Keyframe& kf = map.keyframe(slot);
  KeyframeUse use;
  for (std::size_t f = 0; f < kf.landmark.size(); ++f) {
    if (kf.landmark[f] == kNone) continue;
    const Landmark& point = map.landmark(kf.landmark[f]);
    ++use.seen;
    int others = 0;
    for (int s = 0; s < point.num_sightings && others < kEnoughSightings; ++s) {
      const LandmarkSighting& sighting = point.sightings[static_cast<std::size_t>(s)];
      if (sighting.keyframe == slot) continue;
      const Keyframe& other = map.keyframe(sighting.keyframe);
      if (other.level[static_cast<std::size_t>(sighting.feature)] <= kf.level[f] + 1) ++others;
    }
    if (others < kEnoughSightings) ++use.own;
  }
  return use;
}

void KeyframeRoom::make(Map& map, int max_keyframes) {
  if (map.num_keyframes() < max_keyframes) return;
  std::int32_t least = kNone;
  int least_own = 0;
  for (std::int32_t step = 0, sampled = 0; step < map.keyframe_slots() && sampled < kKeyframeSample; ++step) {
    cursor_ = (cursor_ + 1) % map.keyframe_slots();
    const Keyframe& kf = map.keyframe(cursor_);
    if (!kf.alive || kf.parent_id < 0) continue;
    ++sampled;
    const int own = use_of(map, cursor_).own;
    if (least != kNone && own >= least_own) continue;
    least = cursor_;
    least_own = own;
  }
  if (least != kNone) map.remove_keyframe(least);
}

LandmarkRoom::LandmarkRoom(int max_wanted) {
  sample_.reserve(static_cast<std::size_t>(max_wanted) * kLandmarkSample);
}

void LandmarkRoom::make(Map& map, int max_landmarks, int wanted) {
  const int missing = map.num_landmarks() + wanted - max_landmarks;
  if (missing <= 0) return;
  sample_.clear();
  for (std::int32_t step = 0; step < map.landmark_slots() && sample_.size() < sample_.capacity(); ++step) {
    cursor_ = (cursor_ + 1) % map.landmark_slots();
    const Landmark& point = map.landmark(cursor_);
    // As if it had been found in one of two frames more: of one hardly looked for yet, little is known.
    if (point.alive) {
      sample_.push_back({static_cast<float>(point.found + 1) / static_cast<float>(point.visible + 2), cursor_});
    }
  }
  const auto going = std::min<std::ptrdiff_t>(missing, std::ssize(sample_));
  std::nth_element(sample_.begin(), sample_.begin() + going, sample_.end(), [](const Candidate& a, const Candidate& b) {
    return a.share != b.share ? a.share < b.share : a.slot < b.slot;
  });
  for (std::ptrdiff_t i = 0; i < going; ++i) map.remove_landmark(sample_[static_cast<std::size_t>(i)].slot);
}

}  // namespace povslam
