#include "tools/povslam/replay_objects.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

#include "pipeline/base/log.hpp"
#include "tools/povslam/event_json.hpp"
#include "tools/povslam/mesh_ply.hpp"
#include "tools/povslam/object_picture.hpp"

namespace povslam {
namespace {

using Json = nlohmann::ordered_json;

Json vector_json(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json object_json(const ObjectRecord& object) {
  return {{"id", object.id},
          {"class", object.class_name},
          {"position", vector_json(object.place.position)},
          {"yaw", object.place.yaw},
          {"size", vector_json(object.size_m)},
          {"alpha", object.belief.alpha},
          {"beta", object.belief.beta},
          {"consistency", object.belief.expected_consistency()},
          {"first_seen", to_seconds(object.first_seen)},
          {"last_seen", to_seconds(object.last_seen)},
          {"observations", object.observations},
          {"landmarks", object.landmarks}};
}

}  // namespace

Status write_objects(const std::filesystem::path& out, const ReplayRecord& record) {
  std::ofstream events(out / "events.jsonl", std::ios::binary);
  for (const ObjectEvent& event : record.events) events << event_json(event).dump() << '\n';
  events.close();
  if (!events) return Error{(out / "events.jsonl").string() + ": cannot be written; is the disk full?"};
  Json objects = Json::array();
  for (const ObjectRecord& object : record.objects) objects.push_back(object_json(object));
  std::ofstream list(out / "objects.json", std::ios::binary);
  list << Json{{"objects", objects}}.dump(1) << '\n';
  list.close();
  if (!list) return Error{(out / "objects.json").string() + ": cannot be written; is the disk full?"};
  if (const Status drawn = draw_objects(out / "objects.png", record); !drawn) {
    log::warn("objects.png: {}", drawn.error().message);
  }
  return write_mesh_ply(out / "map.ply", record.mesh);
}

}  // namespace povslam
