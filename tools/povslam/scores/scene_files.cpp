#include "tools/povslam/scores/scene_files.hpp"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace povslam::scores {
namespace {

using Json = nlohmann::json;

Eigen::Vector3d vector_of(const Json& json, const char* key) {
  const auto numbers = json.at(key).get<std::vector<double>>();
  if (numbers.size() != 3) throw std::invalid_argument("key '" + std::string(key) + "': expected three numbers");
  return {numbers[0], numbers[1], numbers[2]};
}

Eigen::Vector3d size_of(const Json& json) {
  const Eigen::Vector3d size_m = vector_of(json, "size");
  if (!(size_m.minCoeff() >= 0.0)) throw std::invalid_argument("key 'size': negative");
  return size_m;
}

OrientedBox box_of(const Json& place, const Eigen::Vector3d& size_m) {
  return {vector_of(place, "position"), size_m, place.at("yaw").get<double>()};
}

std::optional<OrientedBox> place_of(const Json& object, const char* key, const Eigen::Vector3d& size_m) {
  const Json& place = object.at(key);
  if (!place.at("present").get<bool>()) return std::nullopt;
  return box_of(place, size_m);
}

TrueObject true_object(const Json& json) {
  TrueObject object;
  object.id = json.at("id").get<int>();
  object.class_name = json.at("class").get<std::string>();
  object.changed = json.at("change").get<std::string>() != "unchanged";
  if (object.changed) object.switch_time = from_seconds(json.at("switch_time").get<double>());
  object.before = place_of(json, "before", size_of(json));
  object.after = place_of(json, "after", size_of(json));
  return object;
}

ReportedEvent reported_event(const Json& json) {
  ReportedEvent event;
  const std::string type = json.at("type").get<std::string>();
  if (type != "appeared" && type != "moved" && type != "removed") {
    throw std::invalid_argument("key 'type': '" + type + "' is not appeared, moved or removed");
  }
  event.type = type == "appeared" ? EventType::appeared : type == "moved" ? EventType::moved : EventType::removed;
  event.class_name = json.at("class").get<std::string>();
  event.box = box_of(json, size_of(json));
  if (event.type == EventType::moved) event.from = box_of(json.at("from"), event.box.size_m);
  event.object = json.value("object", -1);
  return event;
}

// Runs a reader of JSON; what the file does wrong comes back as an error that begins with `where`.
template <class Read>
auto guarded(const std::string& where, const Read& read) -> Result<decltype(read())> {
  try {
    return read();
  } catch (const Json::parse_error& error) {
    return Error{where + "byte " + std::to_string(error.byte) + ": not JSON"};
  } catch (const Json::exception& error) {
    return Error{where + "key missing or of the wrong kind: " + error.what()};
  } catch (const std::invalid_argument& error) {
    return Error{where + error.what()};
  }
}

Result<std::string> read_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  if (in && std::filesystem::is_regular_file(path)) text << in.rdbuf();
  if (!in || in.bad() || !std::filesystem::is_regular_file(path)) return Error{path.string() + ": cannot read"};
  return text.str();
}

}  // namespace

Result<SceneTruth> read_scene_truth(const std::filesystem::path& objects_truth_json) {
  const Result<std::string> text = read_text(objects_truth_json);
  if (!text) return text.error();
  return guarded(objects_truth_json.string() + ": ", [&] {
    const Json json = Json::parse(*text);
    SceneTruth truth;
    truth.lap1_end = from_seconds(json.at("lap1_end").get<double>());
    for (const Json& object : json.at("objects")) truth.objects.push_back(true_object(object));
    return truth;
  });
}

Result<std::vector<ReportedObject>> read_reported_objects(const std::filesystem::path& objects_json) {
  const Result<std::string> text = read_text(objects_json);
  if (!text) return text.error();
  return guarded(objects_json.string() + ": ", [&] {
    const Json json = Json::parse(*text);
    std::vector<ReportedObject> objects;
    for (const Json& object : json.is_array() ? json : json.at("objects")) {
      objects.push_back(
          {object.at("class").get<std::string>(), box_of(object, size_of(object)), object.value("id", -1)});
    }
    return objects;
  });
}

Result<std::vector<ReportedEvent>> read_events(const std::filesystem::path& events_jsonl) {
  const Result<std::string> text = read_text(events_jsonl);
  if (!text) return text.error();
  std::vector<ReportedEvent> events;
  std::istringstream lines(*text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    Result<ReportedEvent> event = guarded(events_jsonl.string() + ":" + std::to_string(number) + ": ",
                                          [&line] { return reported_event(Json::parse(line)); });
    if (!event) return event.error();
    events.push_back(*event);
  }
  return events;
}

}  // namespace povslam::scores
