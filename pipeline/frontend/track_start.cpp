// How a map begins: with the first frame that shows enough, on an earlier session's, or anew after a false start.
#include <algorithm>

#include "pipeline/frontend/map_loader.hpp"
#include "pipeline/frontend/track.hpp"

namespace povslam {

namespace {
constexpr int kMinToStart = 40;                          // features with depth to begin a map
constexpr double kAnywhereM = 100.0, kAnyTurnRad = 3.0;  // doubt of a pose nobody knows
constexpr int kStartTries = 30;                          // frames
constexpr double kFarBetter = 2.0;                       // as many landmarks as the start shows
constexpr int kFewKeyframes = 3;                         // a map that is nothing yet…
constexpr double kGiveUpS = 2.0;                         // …and in which nothing was found for so long
}  // namespace

// Where on the earlier session's map we are is to be found out.
void Tracker::adopt(const MapContent& content) {
  MapLoader::load(content, camera_, map_);
  places_.update(map_, content.meta.vocabulary == places_.vocabulary());
  journal_.assume_written(map_, content);
  for (std::int32_t slot = 0; slot < map_.landmark_slots(); ++slot) {
    if (map_.landmark(slot).alive) restored_landmarks_.emplace(map_.landmark(slot).id, slot);
  }
  result_.map_version = content.meta.map_version;
  result_.state = TrackState::lost;
  result_.covariance.topLeftCorner<3, 3>().diagonal().setConstant(kAnywhereM * kAnywhereM);
  result_.covariance.bottomRightCorner<3, 3>().diagonal().setConstant(kAnyTurnRad * kAnyTurnRad);
  bad_frames_ = options_.track.frames_to_lost;
  start_tries_ = options_.map.start == "known" ? kStartTries : 0;
}

bool Tracker::found_at_start() {
  if (start_tries_ == 0) return false;
  --start_tries_;
  if (!confirm(T_world_camera_start_.inverse()) || hangs_on_one_thing()) return false;
  if (!far_better_elsewhere()) return true;
  start_tries_ = 0;  // refuted: that the next frame may fit the other place a little worse speaks not for this one
  return false;
}

// A start that is wrong may yet show a few things that were carried: another place that explains far more of the frame
// speaks against it, even if it is not certain itself.
bool Tracker::far_better_elsewhere() {
  const Relocaliser::Answer answer = relocaliser_.search(map_, places_.index(), frame_);
  return believable(answer.fit) && answer.fit.num_inliers > kFarBetter * result_.num_landmarks &&
         !same_pose(answer.fit.T_camera_world, frame_.T_camera_world);
}

bool Tracker::can_begin_map() const {
  int with_depth = 0;
  for (int i = 0; i < frame_.size(); ++i) with_depth += frame_.has_depth(i) ? 1 : 0;
  return with_depth >= kMinToStart;
}

bool Tracker::start_map() {
  if (!can_begin_map()) return false;
  frame_.T_camera_world = T_world_camera_start_.inverse();
  newest_keyframe_ = keyframer_.insert(map_, builder_, frame_, Matrix6d::Zero(), -1);
  places_.update(map_);
  reference_id_ = map_.keyframe(newest_keyframe_).id;
  result_.state = TrackState::ok;
  result_.keyframe = true;
  result_.num_landmarks = map_.num_landmarks();
  return true;
}

// A map begun while a rolling shutter's camera was turning is bent: nothing was known then of its speed. With the
// second frame it is, so both are straightened, the motion between them found again, and the map begins there.
void Tracker::restart_map() {
  constexpr int kRounds = 3;
  std::fill_n(last_.landmark.begin(), last_.size(), kNone);
  for (int round = 0; round < kRounds; ++round) {
    const Rigid3 T_before_now = last_.T_camera_world * frame_.T_camera_world.inverse();
    const Vector6d speed = se3_log(T_before_now) / to_seconds(frame_.stamp - last_.stamp);
    last_.compensate_motion(camera_, speed, rolling_shutter_s_);
    frame_.compensate_motion(camera_, speed, rolling_shutter_s_);
    search_.match_last(map_, last_, frame_, frame_.T_camera_world, static_cast<float>(options_.track.search_radius_px),
                       matcher_);
    observe_matches();
    const PoseSolution solution = solve_pose(camera_, frame_.T_camera_world, observations_, PoseSolverOptions{});
    if (!solution.converged || solution.num_inliers < kMinFromLast) return;
    local_map_.forget();
    std::fill_n(frame_.landmark.begin(), frame_.size(), kNone);
    accept(solution);
  }
  const std::int32_t bent = newest_keyframe_;
  newest_keyframe_ = keyframer_.insert(map_, builder_, frame_, result_.covariance, -1);
  map_.remove_keyframe(bent, newest_keyframe_);
  places_.update(map_);
  reference_id_ = map_.keyframe(newest_keyframe_).id;
  result_.keyframe = true;
}

// Of a moment's glance, lost at once and not found again: a robot that was started behind a hand, before a wall of
// glass or in a fast turn would look for it for ever.
bool Tracker::map_is_worthless(bool tracked) {
  const bool small = map_.num_keyframes() <= kFewKeyframes && restored_landmarks_.empty();
  const bool fruitless = !tracked && result_.state == TrackState::lost && small && can_begin_map();
  fruitless_s_ = fruitless ? fruitless_s_ + std::max(0.0, to_seconds(frame_.stamp - last_.stamp)) : 0.0;
  return fruitless_s_ >= kGiveUpS && options_.map.mode != "localise";
}

// Where the pose is held, with the doubt that has grown since: all that follows is known no better than that.
void Tracker::begin_again() {
  local_map_.forget();
  newest_keyframe_ = keyframer_.insert(map_, builder_, frame_, result_.covariance, -1);
  for (std::int32_t slot = 0; slot < map_.keyframe_slots(); ++slot) {
    if (slot != newest_keyframe_ && map_.keyframe(slot).alive) map_.remove_keyframe(slot, newest_keyframe_);
  }
  places_.update(map_);
  reference_id_ = map_.keyframe(newest_keyframe_).id;
  problem_outdated_ = true;
  ++result_.map_version;
  result_.state = TrackState::degraded;
  result_.keyframe = true;
  result_.num_landmarks = map_.num_landmarks();
  bad_frames_ = good_frames_ = 0;
  unseen_s_ = fruitless_s_ = 0.0;
  regaining_ = false;
  agreement_.forget();
  relocaliser_.start_over();
  name_reference();
}

}  // namespace povslam
