// The tables of a store. All are alike: a number, bytes, and a checksum over table, number and bytes; how many rows
// each has and what all their checksums add up to stands in the manifest, so that rows that vanish are noticed, too.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "daemon/store_sql.hpp"

namespace povslam {

enum class Table : std::uint8_t {
  steps,     // how the store came to its version (store_schema.hpp)
  meta,      // one row
  features,  // by keyframe
  keyframes,
  landmarks,
  looks,  // by landmark
  objects,
  voxel_blocks,  // numbers: store_world_rows.hpp
  events,        // by sequence number
  world,         // one row, or none while nothing of objects and voxels was stored
  empty_cells    // numbers: store_world_rows.hpp
};
inline constexpr std::size_t kNumTables = 11;
inline constexpr std::array<Table, kNumTables> kAllTables = {
    Table::steps,   Table::meta,         Table::features, Table::keyframes, Table::landmarks,  Table::looks,
    Table::objects, Table::voxel_blocks, Table::events,   Table::world,     Table::empty_cells};

const char* name_of(Table table);
int since_version(Table table);  // of the schema

// What a table holds, whatever the order.
struct TableTotal {
  std::uint64_t rows = 0;
  std::uint64_t sum = 0;  // of the rows' marks, modulo 2^64
  bool operator==(const TableTotal&) const = default;
};
using Manifest = std::array<TableTotal, kNumTables>;  // by Table

std::uint32_t checksum(Table table, std::int64_t id, std::span<const std::uint8_t> data);
std::uint64_t row_mark(Table table, std::int64_t id, std::uint32_t checksum);

// Of all tables that the version has. Reading: damage when one is missing or broken.
Manifest read_manifest(const Database& database, int version);
void write_manifest(const Database& database, int version, const Manifest& manifest);

// Puts rows in and takes them out, keeping the manifest. Within a write transaction.
class TableWriter {
 public:
  TableWriter(const Database& database, Table table);
  void put(std::int64_t id, std::span<const std::uint8_t> data, Manifest& manifest);
  void remove(std::int64_t id, Manifest& manifest);                            // one that is not there: nothing
  void remove_all(std::int64_t first, std::int64_t last, Manifest& manifest);  // first <= number <= last

 private:
  void forget(std::int64_t id, TableTotal& total);

  Table table_;
  Statement find_, put_, remove_, find_all_, remove_all_;
};

// Walks a table in order of the numbers and checks each row; check_total() at the end.
class TableReader {
 public:
  TableReader(const Database& database, Table table);
  bool next();
  std::int64_t id() const { return id_; }
  std::span<const std::uint8_t> data() const { return statement_.bytes(1); }  // until next()
  const TableTotal& total() const { return total_; }
  std::uint64_t bytes() const { return bytes_; }
  void check_total(const Manifest& manifest) const;

 private:
  const Database& database_;
  Table table_;
  Statement statement_;
  std::int64_t id_ = 0;
  TableTotal total_;
  std::uint64_t bytes_ = 0;
};

}  // namespace povslam
