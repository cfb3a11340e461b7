// The library as others see it.
#include <algorithm>

#include "pipeline/objects/library.hpp"

namespace povslam {

ObjectRecord ObjectLibrary::record_without_landmarks(const MapObject& object) const {
  const Box box = object.box_world();
  ObjectRecord record;
  record.id = object.id;
  record.phase = object.phase;
  record.class_name = class_of(object).name;
  record.place = {box.center, box.yaw};
  record.size_m = box.size_m;
  record.belief = object.belief;
  record.first_seen = object.first_seen;
  record.last_seen = object.last_seen;
  record.first_absent = object.first_absent;
  record.last_absent = object.last_absent;
  record.observations = object.observations;
  return record;
}

ObjectRecord ObjectLibrary::record_of(const MapObject& object) const {
  ObjectRecord record = record_without_landmarks(object);
  for (const auto& [landmark, owned] : owner_of_landmark_) {
    if (owned.object == object.id) record.landmarks.push_back(landmark);
  }
  std::sort(record.landmarks.begin(), record.landmarks.end());
  return record;
}

// One pass over the landmarks for all objects: there are a hundred thousand.
std::vector<ObjectRecord> ObjectLibrary::standing() const {
  std::vector<ObjectRecord> records;
  std::unordered_map<std::int64_t, std::size_t> index;
  for (const auto& object : objects_) {
    if (object->phase != ObjectPhase::confirmed || is_post(*object)) continue;
    index[object->id] = records.size();
    records.push_back(record_without_landmarks(*object));
  }
  for (const auto& [landmark, owned] : owner_of_landmark_) {
    if (owned.object < 0) continue;
    if (const auto at = index.find(owned.object); at != index.end()) records[at->second].landmarks.push_back(landmark);
  }
  for (ObjectRecord& record : records) std::sort(record.landmarks.begin(), record.landmarks.end());
  return records;
}

}  // namespace povslam
