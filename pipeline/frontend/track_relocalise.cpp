// Where the camera is once it was lost, and what must hold before that is believed.
#include <algorithm>

#include "pipeline/frontend/track.hpp"

namespace povslam {

namespace {
constexpr float kWide = 4.0F;  // widening of the local search around a found place
// No robot, nor a hand, moves faster between the last pose and this one; what would have to is somewhere else.
constexpr double kStepM = 0.05, kMaxSpeedMps = 4.0, kStepRad = 0.05, kMaxTurnRadps = 6.0;
}  // namespace

// One or two frames lost: at the newest place. Really lost: wherever the map looks like the frame, when no other place
// does and the next frames say so too; a robot that was carried to the twin of where it stood must not be found there.
bool Tracker::relocalise() {
  const TrackResult held = result_;
  motion_.forget();
  const bool found = result_.state == TrackState::lost ? found_at_start() || found_anywhere() : found_near();
  if (!found) {
    result_ = held;
    return false;
  }
  agreement_.forget();
  relocaliser_.start_over();
  start_tries_ = 0;
  return true;
}

bool Tracker::found_near() {
  if (newest_keyframe_ == kNone || !map_.keyframe(newest_keyframe_).alive) return false;
  const auto found = relocaliser_.against(map_, newest_keyframe_, frame_);
  return found && confirm(found->T_camera_world) && moved_possibly();
}

bool Tracker::found_anywhere() {
  const Relocaliser::Answer answer = relocaliser_.search(map_, places_.index(), frame_);
  return agreement_.add(answer, frame_.stamp) && confirm(answer.fit.T_camera_world);
}

// Whether the map around a supposed pose shows itself in the frame.
bool Tracker::confirm(const Rigid3& T_camera_world) {
  std::fill_n(frame_.landmark.begin(), frame_.size(), kNone);
  return track_local_map(T_camera_world, kWide) && track_local_map(frame_.T_camera_world, 1.0F) &&
         result_.num_landmarks >= kMinToRelocalise;
}

// Since the last pose that was seen, which last_ holds while none is.
bool Tracker::moved_possibly() const {
  const double passed_s = unseen_s_ + std::max(0.0, to_seconds(frame_.stamp - last_.stamp));
  const Rigid3 moved = last_.T_camera_world * frame_.T_camera_world.inverse();
  return moved.translation.norm() <= kStepM + kMaxSpeedMps * passed_s &&
         rotation_angle_rad(moved) <= kStepRad + kMaxTurnRadps * passed_s;
}

bool Tracker::hangs_on_one_thing() {
  things_.clear();
  for (int i = 0; i < frame_.size(); ++i) {
    const std::int32_t seen = frame_.landmark[static_cast<std::size_t>(i)];
    if (seen != kNone) things_.add(map_.landmark(seen).owner);
  }
  return things_.hangs_on_one();
}

}  // namespace povslam
