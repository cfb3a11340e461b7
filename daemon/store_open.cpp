#include "daemon/store_open.hpp"

#include <unistd.h>

#include "daemon/store_lock.hpp"
#include "daemon/store_schema.hpp"

namespace povslam {
namespace {

void touch(Database& database) {
  database.number("SELECT count(*) FROM sqlite_master");
}

}  // namespace

bool has_log(const std::filesystem::path& file) {
  std::error_code none;
  const std::uintmax_t size = std::filesystem::file_size(beside(file, "-wal"), none);
  return !none && size > 0;
}

void create_if_missing(const std::filesystem::path& file) {
  std::error_code none;
  if (std::filesystem::exists(file, none)) return;
  if (has_log(file)) set_aside(file, "its log is there, but the store itself is not");
  std::filesystem::remove(beside(file, "-wal"), none);  // SQLite would take what is left for the new store's own
  std::filesystem::remove(beside(file, "-shm"), none);
  const std::filesystem::path draft = beside(file, ".new");
  for (const char* ending : {"", "-journal", "-wal", "-shm"}) std::filesystem::remove(beside(draft, ending), none);
  {
    Database database(draft, SqlMode::create);
    migrate(database, 0);
    if (database.text("PRAGMA journal_mode = WAL") != "wal") {
      throw StoreFault{false,
                       file.string() + ": this disk cannot hold a map store (no shared memory); use a local one"};
    }
  }
  std::error_code failed;
  std::filesystem::rename(draft, file, failed);
  if (failed) throw StoreFault{false, file.string() + ": cannot be made: " + failed.message()};
  sync_folder_of(file);
}

std::unique_ptr<Database> open_database(const std::filesystem::path& file, StoreMode mode) {
  if (mode == StoreMode::read_write) {
    auto database = std::make_unique<Database>(file, SqlMode::read_write);
    touch(*database);
    return database;
  }
  try {
    auto database = std::make_unique<Database>(file, SqlMode::read_only);
    touch(*database);
    return database;
  } catch (const StoreFault& fault) {
    // Reading beside a writer needs a file of shared memory, which a read-only folder does not give.
    std::error_code none;
    if (fault.damage || has_log(file) || !std::filesystem::exists(file, none)) throw;
  }
  auto database = std::make_unique<Database>(file, SqlMode::snapshot);
  touch(*database);
  return database;
}

int prepare(Database& database, StoreMode mode) {
  const int version = checked_version(database);
  const std::string structure = database.text("PRAGMA quick_check(1)");
  if (structure != "ok") database.fail_damaged(structure);
  if (mode == StoreMode::read_only) return version;
  if (database.read_only()) {
    // A damaged header makes SQLite take a file for one of a newer format, which it only reads.
    if (access(database.file().c_str(), W_OK) == 0) database.fail_damaged("its header is damaged");
    throw StoreFault{false,
                     database.file().string() + ": cannot be written; file and folder must be writable by this user"};
  }
  if (database.text("PRAGMA journal_mode = WAL") != "wal") database.fail_damaged("its journal mode is damaged");
  if (version < kSchemaVersion) migrate(database, version);
  return kSchemaVersion;
}

}  // namespace povslam
