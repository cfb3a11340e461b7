// The library follows the tracker's map: what hangs on a keyframe that was moved moves along.
#include "pipeline/objects/library.hpp"

namespace povslam {
namespace {

// The upright motion that does to the surroundings of p what T does: things stand, whatever T says of roll and pitch.
Rigid3 upright_at(const Rigid3& T_new_old, const Eigen::Vector3d& p) {
  return upright(T_new_old * p, yaw_of(T_new_old)) * upright(p, 0.0).inverse();
}

}  // namespace

void ObjectLibrary::hang_on(std::int64_t keyframe, TimeNs stamp) {
  for (const auto& object : objects_) {
    if (object->last_seen == stamp) object->keyframe = keyframe;
  }
}

void ObjectLibrary::correct(std::span<const KeyframeMotion> motions) {
  for (const auto& object : objects_) {
    const Rigid3* T_new_old = motion_of(motions, object->keyframe);
    if (T_new_old == nullptr) continue;
    object->T_world_volume = upright_at(*T_new_old, object->box_world().center) * object->T_world_volume;
  }
  for (OldPlace& place : old_places_) {
    const Rigid3* T_new_old = motion_of(motions, place.keyframe);
    if (T_new_old != nullptr) place.box = MapObject::moved(place.box, upright_at(*T_new_old, place.box.center));
  }
  desk_.correct(motions);
}

}  // namespace povslam
