// Files about objects: the truth of a simulated scene, and what a run reported.
// Positions are centres of boxes in the world [m], yaw [rad]. Times are stamps of the sequence [s].
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/base/result.hpp"
#include "pipeline/base/time.hpp"
#include "tools/povslam/scores/oriented_box.hpp"

namespace povslam::scores {

struct TrueObject {
  int id = 0;  // as in the instance images
  std::string class_name;
  bool changed = false;
  TimeNs switch_time = 0;
  std::optional<OrientedBox> before, after;  // nothing: not there
};

struct SceneTruth {
  TimeNs lap1_end = 0;
  std::vector<TrueObject> objects;
};

Result<SceneTruth> read_scene_truth(const std::filesystem::path& objects_truth_json);

struct ReportedObject {
  std::string class_name;
  OrientedBox box;
  int id = -1;  // of the run; -1: not told
};
// objects.json: an array of objects, or an object with the key "objects".
Result<std::vector<ReportedObject>> read_reported_objects(const std::filesystem::path& objects_json);

enum class EventType : std::uint8_t { appeared, moved, removed };

struct ReportedEvent {
  EventType type = EventType::appeared;
  std::string class_name;
  OrientedBox box;                  // removed: where it stood
  std::optional<OrientedBox> from;  // moved only
  int object = -1;                  // id in the run; -1: not told
};
Result<std::vector<ReportedEvent>> read_events(const std::filesystem::path& events_jsonl);

}  // namespace povslam::scores
