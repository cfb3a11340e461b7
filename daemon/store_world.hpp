// Between the tables and what stands where: objects, voxels, empty cells and events of a store read and checked, a
// change put in.
#pragma once

#include "daemon/store.hpp"
#include "daemon/store_table.hpp"
#include "daemon/store_world_rows.hpp"

namespace povslam {

WorldMeta read_world_meta_row(Database& database, int version);

// Within a read transaction. Damage is thrown; left out are blocks without their object, and an object's claim to
// landmarks from next_landmark on: ids that the tracker will give to others.
WorldContent read_world(Database& database, int version, std::int64_t next_landmark);

// The statements that put changes in, prepared once.
class WorldWriter {
 public:
  explicit WorldWriter(Database& database);
  // Within a write transaction.
  void write(const WorldChange& change, Manifest& manifest, CommitReport& report);

 private:
  WorldMeta put_meta(const WorldMeta& meta, Manifest& manifest);
  template <class Row>
  void put(TableWriter& table, std::int64_t number, const Row& row, Manifest& manifest);
  template <class Row, class Put>
  void put_all(const std::vector<Row>& rows, const WorldMeta& meta, CommitReport& report, Put&& put_one);

  Database& database_;
  Bytes bytes_;
  TableWriter meta_, objects_, blocks_, empty_cells_, events_;
};

}  // namespace povslam
