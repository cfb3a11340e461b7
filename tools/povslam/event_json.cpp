#include "tools/povslam/event_json.hpp"

#include <nlohmann/json.hpp>

namespace povslam {
namespace {

using Json = nlohmann::ordered_json;

Json vector_json(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
Json time_json(const std::optional<TimeNs>& time) {
  return time ? Json(to_seconds(*time)) : Json(nullptr);
}

}  // namespace

Json event_json(const ObjectEvent& event) {
  Json json{
      {"seq", event.seq},       {"t", to_seconds(event.stamp)},     {"type", to_string(event.type)},
      {"object", event.object}, {"class", event.class_name},        {"position", vector_json(event.place.position)},
      {"yaw", event.place.yaw}, {"size", vector_json(event.size_m)}};
  if (event.from) json["from"] = {{"position", vector_json(event.from->position)}, {"yaw", event.from->yaw}};
  json["consistency"] = event.consistency;
  json["probability"] = event.probability;
  json["evidence"] = {{"first_absent", time_json(event.evidence.first_absent)},
                      {"last_absent", time_json(event.evidence.last_absent)},
                      {"first_present", to_seconds(event.evidence.first_present)},
                      {"last_present", to_seconds(event.evidence.last_present)}};
  return json;
}

}  // namespace povslam
