#include "pipeline/frontend/map_motion.hpp"

namespace povslam {

void MapMotion::start() {
  for (Motion& motion : motions_) motion = {};
}

void MapMotion::move(Map& map, std::int32_t slot, const Rigid3& T_new_old) {
  Motion& motion = motions_[static_cast<std::size_t>(slot)];
  if (motion.moved) return;
  motion = {true, T_new_old};
  map.keyframe(slot).T_world_camera = T_new_old * map.keyframe(slot).T_world_camera;
}

void MapMotion::carry_newer(Map& map, std::int64_t first_id) {
  for (std::int64_t id = first_id; id < map.next_keyframe_id(); ++id) {  // ids grow, so parents come first
    const std::int32_t slot = map.find_keyframe(id);
    if (slot == kNone) continue;
    const std::int32_t parent = map.find_keyframe(map.keyframe(slot).parent_id);
    if (parent == kNone || !motions_[static_cast<std::size_t>(parent)].moved) continue;
    move(map, slot, motions_[static_cast<std::size_t>(parent)].T_new_old);
  }
}

void MapMotion::carry_landmarks(Map& map, std::int64_t placed) {
  for (std::int32_t slot = 0; slot < map.landmark_slots(); ++slot) {
    Landmark& point = map.landmark(slot);
    if (!point.alive || point.mark == placed) continue;
    const Motion& motion = motions_[static_cast<std::size_t>(point.anchor)];
    if (!motion.moved) continue;
    const Eigen::Quaternionf turn = motion.T_new_old.rotation.cast<float>();
    point.p_world = motion.T_new_old * point.p_world;
    point.toward_camera = motion.T_new_old.rotation * point.toward_camera;
    point.tangent_x = turn * point.tangent_x;
    point.tangent_y = turn * point.tangent_y;
  }
}

Rigid3 MapMotion::of(const Map& map, std::int64_t keyframe_id) const {
  const std::int32_t slot = map.find_keyframe(keyframe_id);
  return slot == kNone ? Rigid3{} : motions_[static_cast<std::size_t>(slot)].T_new_old;
}

}  // namespace povslam
