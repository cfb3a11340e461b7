// What enters the tracker between two frames: answers of the backend, and what became known of objects.
#include <algorithm>
#include <cmath>

#include "pipeline/frontend/track.hpp"

namespace povslam {

namespace {
constexpr double kJumpM = 0.02, kJumpRad = 0.01;  // a correction of the map that is said to be one
}  // namespace

// What was solved beside tracking enters; the last pose moves along with the keyframe it was tracked against.
void Tracker::apply_answers() {
  if (problem_state_ == ProblemState::answered) {
    problem_state_ = ProblemState::idle;
    if (!problem_outdated_) move_with_map(smooth_exchange_.apply(map_, problem_, reference_id_));
  }
  if (const auto T_new_old = loops_.apply(map_, reference_id_)) {
    problem_outdated_ = true;
    move_with_map(*T_new_old);
  }
  if (loops_.join_some(map_)) forget_dead_landmarks();
}

void Tracker::move_with_map(const Rigid3& T_new_old) {
  const Rigid3 before = result_.T_world_camera;
  result_.T_world_camera = T_new_old * before;
  const bool jumped = (result_.T_world_camera.translation - before.translation).norm() > kJumpM ||
                      rotation_angle_rad(T_new_old) > kJumpRad;
  if (jumped) ++result_.map_version;
  frame_.T_camera_world = frame_.T_camera_world * T_new_old.inverse();
  forget_dead_landmarks();
}

void Tracker::forget_dead_landmarks() {
  for (int i = 0; i < frame_.size(); ++i) {
    for (std::int32_t* seen :
         {&frame_.landmark[static_cast<std::size_t>(i)], &frame_.misfit[static_cast<std::size_t>(i)]}) {
      if (*seen != kNone && !map_.landmark(*seen).alive) *seen = kNone;
    }
  }
}

void Tracker::set_owner(std::int32_t slot, std::int64_t landmark, std::int64_t owner) {
  if (slot < 0) {
    const auto restored = restored_landmarks_.find(landmark);
    if (restored == restored_landmarks_.end()) return;
    slot = restored->second;
  }
  if (slot >= map_.landmark_slots()) return;
  Landmark& point = map_.landmark(slot);
  if (point.alive && point.id == landmark) point.owner = owner;
}

void Tracker::remove_landmarks(std::span<const std::pair<std::int32_t, std::int64_t>> slot_and_id) {
  if (options_.map.mode == "localise") return;
  for (const auto& [given, landmark] : slot_and_id) {
    const auto restored = given < 0 ? restored_landmarks_.find(landmark) : restored_landmarks_.end();
    const std::int32_t slot = restored != restored_landmarks_.end() ? restored->second : given;
    if (slot < 0 || slot >= map_.landmark_slots()) continue;
    if (map_.landmark(slot).alive && map_.landmark(slot).id == landmark) map_.remove_landmark(slot);
  }
  forget_dead_landmarks();
}

// What the frame saw stays with it only where the corrected pose explains it; the rest is followed by its depth.
void Tracker::correct(const Rigid3& T_new_old) {
  constexpr double kFitsPx = 4.0;
  move_with_map(T_new_old);
  for (int i = 0; i < frame_.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (frame_.landmark[k] == kNone) continue;
    const Eigen::Vector3d p = frame_.T_camera_world * map_.landmark(frame_.landmark[k]).p_world;
    const double u = camera_.fx * p.x() / p.z() + camera_.cx, v = camera_.fy * p.y() / p.z() + camera_.cy;
    const bool fits =
        p.z() > 0.0 && std::hypot(u - static_cast<double>(frame_.x[k]), v - static_cast<double>(frame_.y[k])) < kFitsPx;
    if (!fits) frame_.landmark[k] = kNone;
  }
}

}  // namespace povslam
