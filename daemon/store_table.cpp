#include "daemon/store_table.hpp"

#include "daemon/store_bytes.hpp"
#include "daemon/store_crc.hpp"

namespace povslam {
namespace {

constexpr std::array<const char*, kNumTables> kNames = {"steps",     "meta",  "features",   "keyframes",
                                                        "landmarks", "looks", "objects",    "voxel_blocks",
                                                        "events",    "world", "empty_cells"};
constexpr std::uint64_t kMarkStride = 9;  // in every store so far; the sums of tables are apart
constexpr std::uint8_t kManifestLayout = 1;
constexpr std::uint8_t kManifestTag = 255;  // in its rows' checksums, where tables have their number

std::size_t index(Table table) {
  return static_cast<std::size_t>(table);
}

std::string sql(const char* before, Table table, const char* after) {
  return std::string(before) + name_of(table) + after;
}

std::uint32_t checksum_of(std::uint8_t tag, std::int64_t id, std::span<const std::uint8_t> data) {
  Bytes key;
  ByteWriter out(key);
  out.number(tag);
  out.number(id);
  return crc32c(data, crc32c(key));
}

// Spreads every bit of x over all others (SplitMix64's finaliser; Steele, Lea & Flood, OOPSLA 2014).
std::uint64_t spread(std::uint64_t x) {
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31U);
}

}  // namespace

const char* name_of(Table table) {
  return kNames[index(table)];
}

int since_version(Table table) {
  return table >= Table::world ? 3 : table >= Table::objects ? 2 : 1;
}

std::uint32_t checksum(Table table, std::int64_t id, std::span<const std::uint8_t> data) {
  return checksum_of(static_cast<std::uint8_t>(table), id, data);
}

std::uint64_t row_mark(Table table, std::int64_t id, std::uint32_t checksum) {
  return spread(spread(static_cast<std::uint64_t>(id) * kMarkStride + index(table) + 1) + checksum);
}

Manifest read_manifest(const Database& database, int version) {
  Manifest manifest{};
  Statement statement(database, "SELECT data, crc FROM manifest WHERE id = ?");
  for (const Table table : kAllTables) {
    if (since_version(table) > version) continue;
    const auto id = static_cast<std::int64_t>(table);
    if (!statement.bind(0, id).step()) database.fail_damaged(sql("the manifest does not know table ", table, ""));
    const bool whole = statement.is_bytes(0) && statement.is_number(1) &&
                       checksum_of(kManifestTag, id, statement.bytes(0)) == statement.number(1);
    ByteReader in(whole ? statement.bytes(0) : std::span<const std::uint8_t>{});
    const bool known = in.number<std::uint8_t>() == kManifestLayout;
    manifest[index(table)] = {in.number<std::uint64_t>(), in.number<std::uint64_t>()};
    if (!known || !in.at_end()) database.fail_damaged(sql("the manifest of table ", table, " is damaged"));
    statement.reset();
  }
  return manifest;
}

void write_manifest(const Database& database, int version, const Manifest& manifest) {
  Statement statement(database, "INSERT OR REPLACE INTO manifest(id, data, crc) VALUES(?, ?, ?)");
  Bytes data;
  for (const Table table : kAllTables) {
    if (since_version(table) > version) continue;
    const auto id = static_cast<std::int64_t>(table);
    ByteWriter out(data);
    out.number(kManifestLayout);
    out.number(manifest[index(table)].rows);
    out.number(manifest[index(table)].sum);
    statement.bind(0, id).bind(1, data).bind(2, checksum_of(kManifestTag, id, data)).run();
  }
}

TableWriter::TableWriter(const Database& database, Table table)
    : table_(table),
      find_(database, sql("SELECT crc FROM ", table, " WHERE id = ?")),
      put_(database, sql("INSERT OR REPLACE INTO ", table, "(id, data, crc) VALUES(?, ?, ?)")),
      remove_(database, sql("DELETE FROM ", table, " WHERE id = ?")),
      find_all_(database, sql("SELECT id, crc FROM ", table, " WHERE id BETWEEN ? AND ?")),
      remove_all_(database, sql("DELETE FROM ", table, " WHERE id BETWEEN ? AND ?")) {}

void TableWriter::forget(std::int64_t id, TableTotal& total) {
  if (find_.bind(0, id).step()) {
    --total.rows;
    total.sum -= row_mark(table_, id, static_cast<std::uint32_t>(find_.number(0)));
  }
  find_.reset();
}

void TableWriter::put(std::int64_t id, std::span<const std::uint8_t> data, Manifest& manifest) {
  TableTotal& total = manifest[index(table_)];
  forget(id, total);
  const std::uint32_t crc = checksum(table_, id, data);
  put_.bind(0, id).bind(1, data).bind(2, crc).run();
  ++total.rows;
  total.sum += row_mark(table_, id, crc);
}

void TableWriter::remove(std::int64_t id, Manifest& manifest) {
  forget(id, manifest[index(table_)]);
  remove_.bind(0, id).run();
}

void TableWriter::remove_all(std::int64_t first, std::int64_t last, Manifest& manifest) {
  TableTotal& total = manifest[index(table_)];
  find_all_.bind(0, first).bind(1, last);
  while (find_all_.step()) {
    --total.rows;
    total.sum -= row_mark(table_, find_all_.number(0), static_cast<std::uint32_t>(find_all_.number(1)));
  }
  find_all_.reset();
  remove_all_.bind(0, first).bind(1, last).run();
}

TableReader::TableReader(const Database& database, Table table)
    : database_(database),
      table_(table),
      statement_(database, sql("SELECT id, data, crc FROM ", table, " ORDER BY id")) {}

bool TableReader::next() {
  if (!statement_.step()) return false;
  const std::int64_t id = statement_.number(0);
  // A broken tree may lead round in circles: its numbers then do not grow.
  if (total_.rows > 0 && id <= id_) database_.fail_damaged(sql("the rows of table ", table_, " are out of order"));
  id_ = id;
  const bool whole = statement_.is_bytes(1) && statement_.is_number(2) &&
                     checksum(table_, id, statement_.bytes(1)) == statement_.number(2);
  if (!whole) database_.fail_damaged(sql("table ", table_, ", row ") + std::to_string(id) + ": the checksum differs");
  ++total_.rows;
  total_.sum += row_mark(table_, id, static_cast<std::uint32_t>(statement_.number(2)));
  bytes_ += statement_.bytes(1).size();
  return true;
}

void TableReader::check_total(const Manifest& manifest) const {
  const TableTotal& expected = manifest[index(table_)];
  if (total_ == expected) return;
  database_.fail_damaged(sql("table ", table_, ": ") + std::to_string(total_.rows) + " rows where the manifest has " +
                         std::to_string(expected.rows) + (total_.rows == expected.rows ? ", but others" : ""));
}

}  // namespace povslam
