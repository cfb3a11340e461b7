#include "tools/povslam/map_info.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <nlohmann/json.hpp>

namespace povslam {
namespace {

template <class... Args>
std::string format(const char* pattern, Args... args) {
  char text[512];
  std::snprintf(text, sizeof text, pattern, args...);
  return text;
}

std::string hex(std::uint64_t value) {
  return format("%016llx", static_cast<unsigned long long>(value));
}

std::string utc(TimeNs time) {
  const std::time_t seconds = time / kNsPerSecond;
  std::tm parts{};
  char text[40] = "?";
  if (gmtime_r(&seconds, &parts) != nullptr) std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

// Of the keyframes' places.
Eigen::AlignedBox3d extent_of(const MapContent& map) {
  Eigen::AlignedBox3d box;
  for (const KeyframeRow& row : map.keyframes) box.extend(row.T_world_camera.translation);
  return box;
}

struct Span {
  TimeNs first = 0, last = 0;
};

Span stamps_of(const MapContent& map) {
  if (map.features.empty()) return {};
  Span span{map.features[0].stamp, map.features[0].stamp};
  for (const KeyframeFeatures& row : map.features) {
    span = {std::min(span.first, row.stamp), std::max(span.last, row.stamp)};
  }
  return span;
}

nlohmann::ordered_json numbers(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

std::size_t count_standing(const WorldContent& world) {
  return static_cast<std::size_t>(std::count_if(world.objects.begin(), world.objects.end(), [](const ObjectRow& row) {
    return row.object.phase == ObjectPhase::confirmed;
  }));
}

double mb(std::uintmax_t bytes) {
  return static_cast<double>(bytes) * 1e-6;
}

}  // namespace

nlohmann::ordered_json map_info_json(const MapReport& report) {
  const StoreInfo& store = report.store;
  const Span stamps = stamps_of(report.content);
  nlohmann::ordered_json json{{"file", report.file.string()},
                              {"file_bytes", store.file_bytes},
                              {"log_bytes", store.log_bytes},
                              {"schema_version", store.schema_version},
                              {"sqlite_version", store.sqlite_version},
                              {"created_utime", store.created / kNsPerUs},
                              {"committed_utime", store.committed / kNsPerUs},
                              {"commits", store.commits},
                              {"map_version", store.meta.map_version},
                              {"vocabulary", hex(store.meta.vocabulary)},
                              {"next_keyframe", store.meta.next_keyframe},
                              {"next_landmark", store.meta.next_landmark},
                              {"keyframes", report.content.keyframes.size()},
                              {"landmarks", report.content.landmarks.size()},
                              {"first_stamp_s", to_seconds(stamps.first)},
                              {"last_stamp_s", to_seconds(stamps.last)}};
  if (const Eigen::AlignedBox3d extent = extent_of(report.content); !extent.isEmpty()) {
    json["extent_min_m"] = numbers(extent.min());
    json["extent_max_m"] = numbers(extent.max());
  }
  json["next_object"] = store.world.next_object;
  json["next_event"] = store.world.next_event_seq;
  json["objects"] = count_standing(report.world);
  json["events"] = report.world.events.size();
  json["voxel_blocks"] = report.world.blocks.size();
  for (const StoreInfo::Rows& table : store.tables) {
    json["tables"][table.table] = {{"rows", table.rows}, {"bytes", table.bytes}};
  }
  return json;
}

std::string map_info_text(const MapReport& report) {
  const StoreInfo& store = report.store;
  std::string text =
      report.file.string() + format(": %zu keyframes, %zu landmarks, %.1f MB", report.content.keyframes.size(),
                                    report.content.landmarks.size(), mb(store.file_bytes));
  if (store.log_bytes > 0) text += format(" and %.1f MB not yet brought in", mb(store.log_bytes));
  text += format("\nmade      %s, last written %s (commit %llu)\n", utc(store.created).c_str(),
                 utc(store.committed).c_str(), static_cast<unsigned long long>(store.commits));
  const Eigen::AlignedBox3d extent = extent_of(report.content);
  if (!extent.isEmpty()) {
    const Eigen::Vector3d& low = extent.min();
    const Eigen::Vector3d& high = extent.max();
    const Span stamps = stamps_of(report.content);
    text += format("cameras   x %.2f to %.2f, y %.2f to %.2f, z %.2f to %.2f m\n", low.x(), high.x(), low.y(), high.y(),
                   low.z(), high.z());
    text += format("stamps    %.3f to %.3f s\n", to_seconds(stamps.first), to_seconds(stamps.last));
  }
  text += format("objects   %zu that stand, %zu voxel blocks, %zu events\n", count_standing(report.world),
                 report.world.blocks.size(), report.world.events.size());
  text += format("versions  schema %d, map %u, vocabulary %s, SQLite %s\n", store.schema_version,
                 store.meta.map_version, hex(store.meta.vocabulary).c_str(), store.sqlite_version.c_str());
  for (const StoreInfo::Rows& table : store.tables) {
    text += format("%-13s %9llu rows %10.3f MB\n", table.table, static_cast<unsigned long long>(table.rows),
                   mb(table.bytes));
  }
  return text;
}

}  // namespace povslam
