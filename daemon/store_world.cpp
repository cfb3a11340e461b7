#include "daemon/store_world.hpp"

#include <algorithm>
#include <unordered_set>

#include "daemon/store_read.hpp"
#include "daemon/store_schema.hpp"

namespace povslam {
namespace {

void drop_loose_ends(WorldContent& content, std::int64_t next_landmark) {
  std::unordered_set<std::int64_t> volumes{kStructureVolume};
  for (ObjectRow& row : content.objects) {
    volumes.insert(row.object.id);
    std::erase_if(row.object.landmarks, [&](std::int64_t id) { return id >= next_landmark; });
  }
  std::erase_if(content.blocks, [&](const VoxelBlockRow& row) { return !volumes.contains(row.volume); });
}

}  // namespace

WorldMeta read_world_meta_row(Database& database, int version) {
  if (since_version(Table::world) > version) return {};
  TableReader reader(database, Table::world);
  if (!reader.next()) return {};
  const std::optional<WorldMeta> meta = reader.id() == 0 ? read_world_meta(reader.data()) : std::nullopt;
  if (!meta || reader.next()) database.fail_damaged("the row of table world is damaged");
  if (const auto fault = fault_in(*meta)) database.fail_damaged(*fault);
  return *meta;
}

WorldContent read_world(Database& database, int version, std::int64_t next_landmark) {
  const Manifest manifest = read_manifest(database, version);
  WorldContent content;
  content.meta = read_world_meta_row(database, version);
  const WorldMeta& meta = content.meta;
  const auto known = [version](Table table) { return since_version(table) <= version; };
  if (known(Table::world)) check_table(database, Table::world, manifest);
  if (known(Table::objects)) read_table(database, Table::objects, manifest, meta, read_object, content.objects);
  if (known(Table::voxel_blocks)) {
    read_table(database, Table::voxel_blocks, manifest, meta, read_block, content.blocks);
  }
  if (known(Table::empty_cells)) {
    read_table(database, Table::empty_cells, manifest, meta, read_empty_cell, content.empty_cells);
  }
  if (known(Table::events)) read_table(database, Table::events, manifest, meta, read_event, content.events);
  drop_loose_ends(content, next_landmark);
  return content;
}

WorldWriter::WorldWriter(Database& database)
    : database_(database),
      meta_(database, Table::world),
      objects_(database, Table::objects),
      blocks_(database, Table::voxel_blocks),
      empty_cells_(database, Table::empty_cells),
      events_(database, Table::events) {}

// Ids once given out stay so, as in the map.
WorldMeta WorldWriter::put_meta(const WorldMeta& meta, Manifest& manifest) {
  const WorldMeta stored = read_world_meta_row(database_, kSchemaVersion);
  WorldMeta next = meta;
  next.next_object = std::max(stored.next_object, meta.next_object);
  next.next_event_seq = std::max(stored.next_event_seq, meta.next_event_seq);
  put(meta_, 0, next, manifest);
  return next;
}

template <class Row>
void WorldWriter::put(TableWriter& table, std::int64_t number, const Row& row, Manifest& manifest) {
  write_row(row, bytes_);
  table.put(number, bytes_, manifest);
}

template <class Row, class Put>
void WorldWriter::put_all(const std::vector<Row>& rows, const WorldMeta& meta, CommitReport& report, Put&& put_one) {
  for (const Row& row : rows) {
    if (const auto fault = fault_in(row, meta)) {
      if (report.rows_left_out++ == 0) report.why_left_out = *fault;
      continue;
    }
    put_one(row);
  }
}

void WorldWriter::write(const WorldChange& change, Manifest& manifest, CommitReport& report) {
  const WorldMeta meta = put_meta(change.meta, manifest);
  put_all(change.objects, meta, report, [&](const ObjectRow& row) { put(objects_, row.object.id, row, manifest); });
  put_all(change.blocks, meta, report, [&](const VoxelBlockRow& row) {
    if (row.weight.empty()) {
      blocks_.remove(*number_of(row), manifest);
    } else {
      put(blocks_, *number_of(row), row, manifest);
    }
  });
  put_all(change.empty_cells, meta, report, [&](const EmptyCellRow& row) {
    if (row.times == 0) {
      empty_cells_.remove(*number_of(row), manifest);
    } else {
      put(empty_cells_, *number_of(row), row, manifest);
    }
  });
  put_all(change.events, meta, report, [&](const ObjectEvent& row) { put(events_, row.seq, row, manifest); });
  for (const std::int64_t id : change.removed_objects) {
    if (id < 0 || id >= meta.next_object) continue;
    objects_.remove(id, manifest);
    const NumberRange blocks = blocks_of_object(id);
    blocks_.remove_all(blocks.first, blocks.last, manifest);
  }
}

}  // namespace povslam
