#include "daemon/store_content.hpp"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "daemon/store_read.hpp"
#include "daemon/store_schema.hpp"

namespace povslam {
namespace {

std::int64_t id_of(const KeyframeFeatures& row) {
  return row.keyframe;
}
std::int64_t id_of(const KeyframeRow& row) {
  return row.keyframe;
}
std::int64_t id_of(const LandmarkRow& row) {
  return row.landmark;
}
std::int64_t id_of(const LandmarkLook& row) {
  return row.landmark;
}

}  // namespace

StoredMeta read_meta_row(Database& database) {
  TableReader reader(database, Table::meta);
  const std::optional<StoredMeta> meta = reader.next() && reader.id() == 0 ? read_meta(reader.data()) : std::nullopt;
  if (!meta || reader.next()) database.fail_damaged("the row of table meta is damaged");
  if (const auto fault = fault_in(meta->map)) database.fail_damaged(*fault);
  return *meta;
}

MapContent read_map(Database& database, int version) {
  const Manifest manifest = read_manifest(database, version);
  MapContent content;
  content.meta = read_meta_row(database).map;
  const MapMeta& meta = content.meta;
  read_table(database, Table::features, manifest, meta, read_features, content.features);
  read_table(database, Table::keyframes, manifest, meta, read_keyframe, content.keyframes);
  read_table(database, Table::landmarks, manifest, meta, read_landmark, content.landmarks);
  read_table(database, Table::looks, manifest, meta, read_look, content.looks);
  for (const Table table : {Table::steps, Table::meta}) check_table(database, table, manifest);
  drop_loose_ends(content);
  return content;
}

std::vector<StoreInfo::Rows> read_totals(Database& database, int version) {
  const Manifest manifest = read_manifest(database, version);
  std::vector<StoreInfo::Rows> totals;
  for (const Table table : kAllTables) {
    if (since_version(table) > version) continue;
    TableReader reader(database, table);
    while (reader.next()) {
    }
    reader.check_total(manifest);
    totals.push_back({name_of(table), reader.total().rows, reader.bytes()});
  }
  return totals;
}

void drop_loose_ends(MapContent& content) {
  std::unordered_map<std::int64_t, std::size_t> features_of;  // keyframe: how many
  for (const KeyframeFeatures& row : content.features) features_of[row.keyframe] = row.x.size();
  std::unordered_set<std::int64_t> keyframes, landmarks, looks;
  std::erase_if(content.keyframes, [&](const KeyframeRow& row) {
    const auto features = features_of.find(row.keyframe);
    return features == features_of.end() || features->second != row.landmark.size();
  });
  for (const KeyframeRow& row : content.keyframes) keyframes.insert(row.keyframe);
  std::erase_if(content.features, [&](const KeyframeFeatures& row) { return !keyframes.contains(row.keyframe); });
  std::erase_if(content.landmarks, [&](const LandmarkRow& row) { return !keyframes.contains(row.anchor); });
  for (const LandmarkRow& row : content.landmarks) landmarks.insert(row.landmark);
  std::erase_if(content.looks, [&](const LandmarkLook& row) { return !landmarks.contains(row.landmark); });
  for (const LandmarkLook& row : content.looks) looks.insert(row.landmark);
  for (LandmarkRow& row : content.landmarks) row.has_patch = row.has_patch && looks.contains(row.landmark);
}

ContentWriter::ContentWriter(Database& database)
    : database_(database),
      world_(database),
      meta_(database, Table::meta),
      features_(database, Table::features),
      keyframes_(database, Table::keyframes),
      landmarks_(database, Table::landmarks),
      looks_(database, Table::looks) {}

template <class Row>
void ContentWriter::put_all(TableWriter& table, const std::vector<Row>& rows, const MapMeta& meta,
                            CommitReport& report) {
  for (const Row& row : rows) {
    if (const auto fault = fault_in(row, meta)) {
      if (report.rows_left_out++ == 0) report.why_left_out = *fault;
      continue;
    }
    write_row(row, bytes_);
    table.put(id_of(row), bytes_, manifest_);
  }
}

// Ids once given out stay so, whatever the change says: rows of before are judged by them.
StoredMeta ContentWriter::put_meta(const MapChange* map) {
  StoredMeta stored = read_meta_row(database_);
  if (map != nullptr) {
    const std::int64_t next_keyframe = std::max(stored.map.next_keyframe, map->meta.next_keyframe);
    const std::int64_t next_landmark = std::max(stored.map.next_landmark, map->meta.next_landmark);
    stored.map = map->meta;
    stored.map.next_keyframe = next_keyframe;
    stored.map.next_landmark = next_landmark;
  }
  ++stored.commits;
  stored.committed = wall_now();
  write_row(stored, bytes_);
  meta_.put(0, bytes_, manifest_);
  return stored;
}

CommitReport ContentWriter::write(const MapChange* map, const WorldChange* world) {
  manifest_ = read_manifest(database_, kSchemaVersion);
  const StoredMeta meta = put_meta(map);
  CommitReport report;
  report.number = meta.commits;
  if (map != nullptr) write_map(*map, meta.map, report);
  if (world != nullptr) world_.write(*world, manifest_, report);
  write_manifest(database_, kSchemaVersion, manifest_);
  return report;
}

void ContentWriter::write_map(const MapChange& change, const MapMeta& meta, CommitReport& report) {
  put_all(features_, change.features, meta, report);
  put_all(keyframes_, change.keyframes, meta, report);
  put_all(landmarks_, change.landmarks, meta, report);
  put_all(looks_, change.looks, meta, report);
  for (const std::int64_t id : change.removed_keyframes) {
    features_.remove(id, manifest_);
    keyframes_.remove(id, manifest_);
  }
  for (const std::int64_t id : change.removed_landmarks) {
    landmarks_.remove(id, manifest_);
    looks_.remove(id, manifest_);
  }
}

}  // namespace povslam
