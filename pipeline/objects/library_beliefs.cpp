// What tracking is told of the library.
#include "pipeline/objects/library.hpp"

#include <algorithm>

namespace povslam {

ObjectBelief ObjectLibrary::belief_of(const MapObject& object) const {
  const ObjectClass& object_class = class_of(object);
  const Box box = object.box_world();
  ObjectBelief belief;
  belief.object = object.id;
  belief.place = {box.center, box.yaw};
  belief.belief = object.belief;
  belief.kind = object_class.kind;
  belief.k_inlier = object_class.k_inlier;
  belief.k_outlier = object_class.k_outlier;
  return belief;
}

std::vector<ObjectBelief> ObjectLibrary::beliefs(const LibraryStep& step) const {
  std::vector<ObjectBelief> told;
  for (const std::int64_t id : step.removed) {
    ObjectBelief& belief = told.emplace_back();
    belief.object = id;
    belief.gone = true;
  }
  for (const auto& object : objects_) {
    const bool changed = std::ranges::find(step.changed, object->id) != step.changed.end();
    if (changed && object->phase == ObjectPhase::confirmed) told.push_back(belief_of(*object));
  }
  return told;
}

void ObjectLibrary::tell_restored(std::vector<LandmarkOwner>& owners, std::vector<ObjectBelief>& beliefs) const {
  for (const auto& [landmark, owned] : owner_of_landmark_) owners.push_back({landmark, owned.slot, owned.object});
  std::ranges::sort(owners, {}, &LandmarkOwner::landmark);
  for (const auto& object : objects_) beliefs.push_back(belief_of(*object));
}

}  // namespace povslam
