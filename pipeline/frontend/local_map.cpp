#include "pipeline/frontend/local_map.hpp"

#include <algorithm>

namespace povslam {

namespace {
constexpr std::size_t kMaxSharing = 24;   // keyframes that share landmarks with the frame
constexpr std::int32_t kShareOfMost = 4;  // of what the first shares, a keyframe that hangs together with it
constexpr std::int64_t kYoungKeyframes = 20;
constexpr std::size_t kMaxNeighbours = 16;  // of those, more keyframes
constexpr std::size_t kMaxNear = 16;        // by place alone
constexpr std::size_t kMaxLandmarks = 6000;
constexpr double kNearM = 4.0;
constexpr double kSameDirection = 0.5;  // cos 60 degrees between optical axes
}  // namespace

LocalMap::LocalMap(const MapOptions& options)
    : max_keyframes_(kMaxSharing + kMaxNeighbours + kMaxNear), max_landmarks_(kMaxLandmarks) {
  keyframes_.reserve(max_keyframes_);
  sharing_.reserve(static_cast<std::size_t>(options.max_keyframes));
  scratch_.reserve(static_cast<std::size_t>(options.max_keyframes));
  landmarks_.reserve(max_landmarks_);
}

void LocalMap::collect(Map& map, const Frame& frame, const Rigid3& T_world_camera) {
  keyframes_.clear();
  landmarks_.clear();
  mark_ = map.new_mark();
  find_sharing(map, frame);
  add_sharing(map, true);
  add_neighbours(map);
  const std::size_t joined = keyframes_.size();
  add_sharing(map, false);
  add_standing_near(map, T_world_camera);
  gather_landmarks(map, 0, joined);
  num_joined_ = landmarks_.size();
  gather_landmarks(map, joined, keyframes_.size());
}

void LocalMap::find_sharing(Map& map, const Frame& frame) {
  sharing_.clear();
  for (std::int32_t s = 0; s < map.keyframe_slots(); ++s) map.keyframe(s).votes = 0;
  for (int i = 0; i < frame.size(); ++i) {
    const std::int32_t slot = frame.landmark[static_cast<std::size_t>(i)];
    if (slot == kNone) continue;
    const Landmark& point = map.landmark(slot);
    for (int s = 0; s < point.num_sightings; ++s) {
      const std::int32_t kf = point.sightings[static_cast<std::size_t>(s)].keyframe;
      if (map.keyframe(kf).votes++ == 0) sharing_.push_back(kf);
    }
  }
  std::sort(sharing_.begin(), sharing_.end(), [&map](std::int32_t a, std::int32_t b) {
    const std::int32_t va = map.keyframe(a).votes, vb = map.keyframe(b).votes;
    return va != vb ? va > vb : map.keyframe(a).id > map.keyframe(b).id;
  });
  sharing_.resize(std::min(sharing_.size(), kMaxSharing));
}

// Joined are those that share much, and those made on the way just come.
void LocalMap::add_sharing(Map& map, bool joined) {
  if (sharing_.empty()) return;
  const std::int32_t enough = map.keyframe(sharing_.front()).votes / kShareOfMost + 1;
  const std::int64_t young = map.next_keyframe_id() - kYoungKeyframes;
  for (const std::int32_t slot : sharing_) {
    Keyframe& kf = map.keyframe(slot);
    if (kf.mark == mark_ || (joined && kf.votes < enough && kf.id < young)) continue;
    keyframes_.push_back(slot);
    kf.mark = mark_;
  }
}

void LocalMap::add_neighbours(Map& map) {
  const std::size_t sharing = keyframes_.size();
  for (std::size_t k = 0; k < sharing; ++k) {
    const Keyframe& kf = map.keyframe(keyframes_[k]);
    for (int c = 0; c < std::min(kf.num_covisible, 6); ++c) {
      if (keyframes_.size() == sharing + kMaxNeighbours) return;
      Keyframe& neighbour = map.keyframe(kf.covisible[static_cast<std::size_t>(c)].keyframe);
      if (neighbour.mark == mark_) continue;
      neighbour.mark = mark_;
      keyframes_.push_back(kf.covisible[static_cast<std::size_t>(c)].keyframe);
    }
  }
}

void LocalMap::add_standing_near(Map& map, const Rigid3& T_world_camera) {
  scratch_.clear();
  const Eigen::Vector3d axis = T_world_camera.rotation * Eigen::Vector3d::UnitZ();
  const auto distance2 = [&](std::int32_t s) {
    return (map.keyframe(s).T_world_camera.translation - T_world_camera.translation).squaredNorm();
  };
  for (std::int32_t s = 0; s < map.keyframe_slots(); ++s) {
    const Keyframe& kf = map.keyframe(s);
    if (!kf.alive || kf.mark == mark_ || distance2(s) > kNearM * kNearM) continue;
    if ((kf.T_world_camera.rotation * Eigen::Vector3d::UnitZ()).dot(axis) < kSameDirection) continue;
    scratch_.push_back(s);
  }
  std::sort(scratch_.begin(), scratch_.end(), [&](std::int32_t a, std::int32_t b) {
    const double da = distance2(a), db = distance2(b);
    return da != db ? da < db : map.keyframe(a).id < map.keyframe(b).id;
  });
  scratch_.resize(std::min(scratch_.size(), kMaxNear));
  for (const std::int32_t slot : scratch_) {
    keyframes_.push_back(slot);
    map.keyframe(slot).mark = mark_;
  }
}

void LocalMap::gather_landmarks(Map& map, std::size_t first, std::size_t last) {
  for (std::size_t k = first; k < last; ++k) {
    for (const std::int32_t slot : map.keyframe(keyframes_[k]).landmark) {
      if (slot == kNone || map.landmark(slot).mark == mark_) continue;
      if (landmarks_.size() == max_landmarks_) return;
      map.landmark(slot).mark = mark_;
      landmarks_.push_back(slot);
    }
  }
}

}  // namespace povslam
