// Between the tables and the map's values: everything of a store read and checked, a change put in.
#pragma once

#include "daemon/store.hpp"
#include "daemon/store_rows.hpp"
#include "daemon/store_table.hpp"

namespace povslam {

StoredMeta read_meta_row(Database& database);

// Within a read transaction. Damage is thrown; loose ends are left out.
MapContent read_content(Database& database, int version);
std::vector<StoreInfo::Rows> read_totals(Database& database, int version);

// What lost its other half: features and keyframes that do not belong together, landmarks without anchor, looks without
// landmark.
void drop_loose_ends(MapContent& content);

// The statements that put changes in, prepared once.
class ContentWriter {
 public:
  ContentWriter(Database& database, int version);
  CommitReport write(const MapChange& change);  // within a write transaction

 private:
  template <class Row>
  void put_all(TableWriter& table, const std::vector<Row>& rows, const MapMeta& meta, CommitReport& report);
  StoredMeta put_meta(const MapMeta& meta);

  Database& database_;
  int version_;
  Manifest manifest_{};
  Bytes bytes_;
  TableWriter meta_, features_, keyframes_, landmarks_, looks_;
};

}  // namespace povslam
