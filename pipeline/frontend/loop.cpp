#include "pipeline/frontend/loop.hpp"

#include <algorithm>
#include <utility>

namespace povslam {

namespace {
constexpr std::int64_t kYoungKeyframes = 15;  // made less than so many ago: no loop, but the way just come
constexpr int kAgreeing = 3;                  // keyframes that must say the same…
constexpr int kForgiven = 1;                  // …between which so many may say nothing
constexpr double kAgreeM = 0.2, kAgreeRad = 0.06;
constexpr float kScoreShare = 0.5F;  // of the score of the likest keyframe that is connected
constexpr int kRivals = 4;           // other places looked at before one is believed
constexpr double kNearlyAsGood = 0.5;
// More than this tracking does not drift: what lies further off only looks the same.
constexpr double kDriftBaseM = 0.3, kDriftShare = 0.05;
constexpr std::int64_t kWayKeyframes = 2000;  // the way is followed back over so many
// Nearer than this, or than what the keyframes that recognised the place differ by, nothing needs to move.
constexpr double kInPlaceM = 0.02, kInPlaceRad = 0.006;
constexpr std::size_t kMaxToJoin = 12, kMaxToSmooth = 6;
}  // namespace

LoopCloser::LoopCloser(const PinholeCamera& camera, const FrontendOptions& options)
    : verifier_(camera, options), exchange_(options.map), fuser_(camera, options), max_old_landmarks_(4000) {
  old_landmarks_.reserve(max_old_landmarks_);
  generations_.reserve(max_old_landmarks_);
  to_join_.reserve(kMaxToJoin + 1);
  to_smooth_.reserve(kMaxToSmooth);
}

void LoopCloser::look(Map& map, PlaceIndex& index, std::int32_t keyframe, std::int64_t frame_index) {
  if (state_ != State::idle || !to_join_.empty()) return;
  const auto found = recognise(map, index, keyframe);
  if (!found) return;
  const Suspicion said = std::exchange(suspicion_, {});
  const Rigid3 T_now_asked = map.keyframe(keyframe).T_world_camera.inverse() *
                             (map.keyframe(map.find_keyframe(found->then)).T_world_camera * found->T_then_now);
  if (T_now_asked.translation.norm() < std::max(kInPlaceM, said.spread_m) &&
      rotation_angle_rad(T_now_asked) < std::max(kInPlaceRad, said.spread_rad)) {
    ++counts_.joined;
    begin_joining(map, *found);
  } else if (exchange_.cut(map, *found, frame_index, problem_)) {
    found_ = *found;
    state_ = State::offered;
  }
}

// What shares landmarks with the keyframe, or with what shares with it, is no old place.
void LoopCloser::leave_out_connected(const Map& map, PlaceIndex& index, std::int32_t slot) {
  const Keyframe& kf = map.keyframe(slot);
  index.leave_out(slot);
  for (int c = 0; c < kf.num_covisible; ++c) {
    const std::int32_t near = kf.covisible[static_cast<std::size_t>(c)].keyframe;
    index.leave_out(near);
    const Keyframe& neighbour = map.keyframe(near);
    for (int d = 0; d < neighbour.num_covisible; ++d) {
      index.leave_out(neighbour.covisible[static_cast<std::size_t>(d)].keyframe);
    }
  }
  for (std::int64_t id = std::max<std::int64_t>(0, kf.id - kYoungKeyframes); id < kf.id; ++id) {
    const std::int32_t young = map.find_keyframe(id);
    if (young != kNone) index.leave_out(young);
  }
}

std::optional<LoopFound> LoopCloser::recognise(Map& map, PlaceIndex& index, std::int32_t slot) {
  const Keyframe& kf = map.keyframe(slot);
  const FeatureView view(kf);
  const auto nothing_here = [this]() -> std::optional<LoopFound> {
    if (++suspicion_.missed > kForgiven) suspicion_ = {};
    return std::nullopt;
  };
  index.query(kf.word);
  float connected = 0.0F;
  for (int c = 0; c < kf.num_covisible; ++c) {
    connected = std::max(connected, index.score(kf.covisible[static_cast<std::size_t>(c)].keyframe));
  }
  leave_out_connected(map, index, slot);
  const auto likely = index.next();
  if (!likely || likely->score < kScoreShare * connected) return nothing_here();
  const PlaceAround place(map, likely->keyframe);
  const auto fit = verifier_.verify(map, place.keyframes(), view);
  if (!fit || !believable(*fit)) return nothing_here();
  const Rigid3 T_world_now = fit->T_camera_world.inverse();
  if (!plausible(map, slot, likely->keyframe, T_world_now)) return nothing_here();
  ++counts_.suspected;
  if (!agrees(kf.T_world_camera, T_world_now)) return std::nullopt;
  for (const std::int32_t near : place.keyframes()) index.leave_out(near);
  if (rivalled(map, index, view, *fit)) return nothing_here();
  const Keyframe& then = map.keyframe(likely->keyframe);
  return LoopFound{kf.id, then.id, then.T_world_camera.inverse() * T_world_now, fit->num_inliers};
}

// The way from the old keyframe to this one, over all keyframes made in between, bounds what tracking can be off.
bool LoopCloser::plausible(const Map& map, std::int32_t now, std::int32_t then, const Rigid3& T_world_now) const {
  double way_m = 0.0;
  Eigen::Vector3d last = map.keyframe(then).T_world_camera.translation;
  const std::int64_t end = map.keyframe(now).id;
  for (std::int64_t id = std::max(map.keyframe(then).id + 1, end - kWayKeyframes); id <= end; ++id) {
    const std::int32_t slot = map.find_keyframe(id);
    if (slot == kNone) continue;
    way_m += (map.keyframe(slot).T_world_camera.translation - last).norm();
    last = map.keyframe(slot).T_world_camera.translation;
  }
  return (T_world_now.translation - map.keyframe(now).T_world_camera.translation).norm() <
         kDriftBaseM + kDriftShare * way_m;
}

bool LoopCloser::agrees(const Rigid3& T_world_old, const Rigid3& T_world_new) {
  const Rigid3 expected = suspicion_.T_new_old * T_world_old;
  const Rigid3 off = expected.inverse() * T_world_new;
  const bool same = suspicion_.agreeing > 0 && off.translation.norm() < kAgreeM && rotation_angle_rad(off) < kAgreeRad;
  const double spread_m = same ? std::max(suspicion_.spread_m, off.translation.norm()) : 0.0;
  const double spread_rad = same ? std::max(suspicion_.spread_rad, rotation_angle_rad(off)) : 0.0;
  suspicion_ = {same ? suspicion_.agreeing + 1 : 1, 0, T_world_new * T_world_old.inverse(), spread_m, spread_rad};
  return suspicion_.agreeing >= kAgreeing;
}

bool LoopCloser::rivalled(const Map& map, PlaceIndex& index, const FeatureView& view, const PlaceFit& best) {
  for (int tried = 0; tried < kRivals; ++tried) {
    const auto other = index.next();
    if (!other) return false;
    const PlaceAround place(map, other->keyframe);
    for (const std::int32_t near : place.keyframes()) index.leave_out(near);
    const auto fit = verifier_.verify(map, place.keyframes(), view);
    if (fit && fit->num_inliers > kNearlyAsGood * best.num_inliers &&
        !same_pose(fit->T_camera_world, best.T_camera_world)) {
      return true;
    }
  }
  return false;
}

LoopProblem* LoopCloser::take() {
  if (state_ != State::offered) return nullptr;
  state_ = State::out;
  return &problem_;
}

void LoopCloser::give_back(LoopProblem* problem) {
  EXPECTS(problem == &problem_ && state_ == State::out);
  state_ = State::answered;
}

std::optional<Rigid3> LoopCloser::apply(Map& map, std::int64_t follow_id) {
  if (state_ != State::answered) return std::nullopt;
  state_ = State::idle;
  const auto T_new_old = exchange_.apply(map, problem_, follow_id);
  ++(T_new_old ? counts_.closed : counts_.refused);
  if (T_new_old) begin_joining(map, found_);
  return T_new_old;
}

void LoopCloser::begin_joining(const Map& map, const LoopFound& found) {
  const std::int32_t now = map.find_keyframe(found.now), then = map.find_keyframe(found.then);
  if (now == kNone || then == kNone) return;
  const PlaceAround here(map, now), there(map, then);
  to_join_.clear();
  for (const std::int32_t slot : here.keyframes()) to_join_.push_back(map.keyframe(slot).id);
  std::ranges::reverse(to_join_);
  old_landmarks_.clear();
  generations_.clear();
  for (const std::int32_t slot : there.keyframes()) {
    for (const std::int32_t seen : map.keyframe(slot).landmark) {
      if (seen == kNone || !map.believed(seen) || old_landmarks_.size() == max_old_landmarks_) continue;
      old_landmarks_.push_back(seen);
      generations_.push_back(map.landmark(seen).generation);
    }
  }
  to_smooth_.assign({found.then, found.now});
}

bool LoopCloser::join_some(Map& map) {
  while (!to_join_.empty()) {
    const std::int32_t slot = map.find_keyframe(to_join_.back());
    to_join_.pop_back();
    if (slot == kNone) continue;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < old_landmarks_.size(); ++i) {
      const Landmark& point = map.landmark(old_landmarks_[i]);
      if (!point.alive || point.generation != generations_[i]) continue;
      old_landmarks_[kept] = old_landmarks_[i];
      generations_[kept++] = generations_[i];
    }
    old_landmarks_.resize(kept);
    generations_.resize(kept);
    fuser_.fuse(map, slot, old_landmarks_);
    return true;
  }
  return false;
}

std::int32_t LoopCloser::next_to_smooth(const Map& map) {
  while (to_join_.empty() && !to_smooth_.empty()) {
    const std::int32_t slot = map.find_keyframe(to_smooth_.back());
    to_smooth_.pop_back();
    if (slot != kNone) return slot;
  }
  return kNone;
}

}  // namespace povslam
