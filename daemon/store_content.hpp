// Between the tables and the map's values: everything of a store read and checked, a change put in.
#pragma once

#include "daemon/store.hpp"
#include "daemon/store_rows.hpp"
#include "daemon/store_table.hpp"
#include "daemon/store_world.hpp"

namespace povslam {

StoredMeta read_meta_row(Database& database);

// Within a read transaction. Damage is thrown; loose ends are left out.
MapContent read_map(Database& database, int version);
std::vector<StoreInfo::Rows> read_totals(Database& database, int version);

// What lost its other half: features and keyframes that do not belong together, landmarks without anchor, looks without
// landmark.
void drop_loose_ends(MapContent& content);

// The statements that put changes in, prepared once.
class ContentWriter {
 public:
  explicit ContentWriter(Database& database);
  // Within a write transaction; null: nothing of that kind.
  CommitReport write(const MapChange* map, const WorldChange* world);

 private:
  template <class Row>
  void put_all(TableWriter& table, const std::vector<Row>& rows, const MapMeta& meta, CommitReport& report);
  StoredMeta put_meta(const MapChange* map);
  void write_map(const MapChange& change, const MapMeta& meta, CommitReport& report);

  Database& database_;
  Manifest manifest_{};
  Bytes bytes_;
  WorldWriter world_;
  TableWriter meta_, features_, keyframes_, landmarks_, looks_;
};

}  // namespace povslam
