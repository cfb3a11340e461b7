#include "daemon/store_schema.hpp"

#include <algorithm>
#include <map>

#include "daemon/store_rows.hpp"

namespace povslam {
namespace {

constexpr int kApplicationId = 0x504F5653;  // "POVS"; tells `file` and us whose database this is

struct Step {
  int version;
  const char* what;
};
constexpr Step kSteps[] = {
    {1, "keyframes, landmarks and their looks"},
    {2, "room for objects, voxel blocks and events"},
    {3, "objects, voxel blocks, empty cells and events"},
};
static_assert(kSteps[std::size(kSteps) - 1].version == kSchemaVersion);

std::string create_table(const std::string& name) {
  return "CREATE TABLE " + name + "(id INTEGER PRIMARY KEY, data BLOB NOT NULL, crc INTEGER NOT NULL)";
}

std::map<std::string, std::string> tables_of(int version) {
  std::map<std::string, std::string> tables{{"manifest", create_table("manifest")}};
  for (const Table table : kAllTables) {
    if (since_version(table) <= version) tables[name_of(table)] = create_table(name_of(table));
  }
  return tables;
}

void apply(Database& database, const Step& step, Manifest& manifest) {
  if (step.version == 1) database.run(create_table("manifest"));
  for (const Table table : kAllTables) {
    if (since_version(table) == step.version) database.run(create_table(name_of(table)));
  }
  if (step.version == 1) {
    StoredMeta meta;
    meta.created = meta.committed = wall_now();
    Bytes data;
    write_row(meta, data);
    TableWriter(database, Table::meta).put(0, data, manifest);
  }
  const std::string done = std::string(step.what) + "; povslam " POVSLAM_VERSION;
  TableWriter(database, Table::steps).put(step.version, Bytes(done.begin(), done.end()), manifest);
}

// The version stands twice, so that a flipped bit in one is not taken for a newer store.
int version_of(Database& database) {
  const std::int64_t version = database.number("PRAGMA user_version");
  std::int64_t steps = 0;
  TableReader reader(database, Table::steps);
  while (reader.next() && reader.id() == steps + 1) ++steps;
  if (version < 1 || version != steps) database.fail_damaged("its version is damaged");
  return static_cast<int>(version);
}

void check_form(Database& database, int version) {
  std::map<std::string, std::string> found;
  Statement statement(database, "SELECT name, sql FROM sqlite_master");
  const std::map<std::string, std::string> expected = tables_of(version);
  while (statement.step() && found.size() <= expected.size()) found[statement.text(0)] = statement.text(1);
  if (found != expected) database.fail_damaged("its tables are not those of a map store");
}

}  // namespace

int checked_version(Database& database) {
  if (database.number("PRAGMA application_id") != kApplicationId) database.fail_damaged("this is no map store");
  const int version = version_of(database);
  if (version > kSchemaVersion) {
    throw StoreFault{false, database.file().string() + ": its version is " + std::to_string(version) +
                                " and this povslam knows those up to " + std::to_string(kSchemaVersion) +
                                "; it is left as it is: install a newer povslam, or name another file"};
  }
  check_form(database, version);
  return version;
}

void migrate(Database& database, int from, int version) {
  Transaction transaction(database, Transaction::Kind::write);
  Manifest manifest = from > 0 ? read_manifest(database, from) : Manifest{};
  for (const Step& step : kSteps) {
    if (step.version > from && step.version <= version) apply(database, step, manifest);
  }
  write_manifest(database, version, manifest);
  database.run("PRAGMA application_id = " + std::to_string(kApplicationId));
  database.run("PRAGMA user_version = " + std::to_string(version));
  transaction.commit();
}

}  // namespace povslam
