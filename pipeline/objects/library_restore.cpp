// What an earlier session knew.
#include <algorithm>

#include "pipeline/objects/library.hpp"
#include "pipeline/objects/restore_block.hpp"

namespace povslam {

void ObjectLibrary::restore(const WorldMeta& meta) {
  next_id_ = std::max(next_id_, meta.next_object);
  desk_.continue_at(meta.next_event_seq);
}

void ObjectLibrary::restore(const ObjectRow& row, std::span<const VoxelBlockRow* const> blocks) {
  const ObjectRecord& record = row.object;
  VolumeOptions volume = volume_options_;
  volume.voxel_size_m = row.voxel_size_m;
  volume.truncation_m = row.truncation_m;
  auto object = std::make_unique<MapObject>(record.id, volume);
  object->phase = ObjectPhase::confirmed;
  const auto named = std::ranges::find(classes_.classes, record.class_name, &ObjectClass::name);
  object->class_votes[named == classes_.classes.end() ? unknown_class_.id : named->id] = record.observations;
  object->belief = record.belief;
  object->T_world_volume = row.T_world_volume;
  object->first_seen = record.first_seen;
  object->last_seen = record.last_seen;
  object->first_absent = record.first_absent;
  object->last_absent = record.last_absent;
  object->observations = record.observations;
  object->announced = row.announced;
  for (const VoxelBlockRow* block : blocks) {
    restore_block(*block, object->volume);
    for (const std::uint16_t weight : block->weight) {
      object->looks = std::max(object->looks, static_cast<double>(weight) / kWeightUnits);
    }
  }
  reshape(*object);
  for (const std::int64_t landmark : record.landmarks) owner_of_landmark_[landmark] = {record.id, -1};
  next_id_ = std::max(next_id_, record.id + 1);
  objects_.push_back(std::move(object));
}

}  // namespace povslam
