#include "daemon/store.hpp"

#include <sqlite3.h>

#include <new>
#include <optional>

#include "daemon/store_content.hpp"
#include "daemon/store_lock.hpp"
#include "daemon/store_open.hpp"
#include "daemon/store_schema.hpp"

namespace povslam {

struct MapStore::Impl {
  Impl(std::filesystem::path store, StoreMode how) : file(std::move(store)), mode(how) {}

  std::filesystem::path file;  // no symbolic link
  StoreMode mode;
  std::optional<StoreLock> lock;
  int version = 0;
  std::unique_ptr<Database> database;
  std::optional<ContentWriter> writer;  // goes before the database
  bool suspect = false;                 // the last commit failed

  static Result<std::unique_ptr<Impl>> make(const std::filesystem::path& file, StoreMode mode);
  void connect();
  void disconnect();
  void recover();
  struct Content {
    MapContent map;
    WorldContent world;
  };
  Content read();
  std::optional<std::string> try_read(Content& content);
  CommitReport commit(const MapChange* map, const WorldChange* world);
};

namespace {

// Runs `work` at the door: what is thrown inside becomes an Error.
template <class Work>
auto at_the_door(const std::filesystem::path& file, Work&& work) -> Result<decltype(work())> {
  try {
    return work();
  } catch (const StoreFault& fault) {
    return Error{fault.message};
  } catch (const std::bad_alloc&) {
    return Error{file.string() + ": not enough memory"};
  }
}

}  // namespace

// For writing: the folder is there and the lock held.
Result<std::unique_ptr<MapStore::Impl>> MapStore::Impl::make(const std::filesystem::path& file, StoreMode mode) {
  std::error_code failed;
  const std::filesystem::path real = std::filesystem::weakly_canonical(std::filesystem::absolute(file), failed);
  if (failed) return Error{file.string() + ": " + failed.message()};
  auto impl = std::make_unique<Impl>(real, mode);
  if (mode == StoreMode::read_only) return impl;
  std::filesystem::create_directories(real.parent_path(), failed);
  if (failed) {
    return Error{real.parent_path().string() + ": the folder of the map cannot be made: " + failed.message() +
                 "; make it, writable by this user"};
  }
  Result<StoreLock> lock = StoreLock::take(real);
  if (!lock) return lock.error();
  impl->lock.emplace(std::move(*lock));
  return impl;
}

// After a failed commit. A disk that was away and came back is not seen through handles from before. And what could not
// be synced may stand in the log for readers without ever reaching the disk: all of the log is written anew, into the
// file, before anything builds on it.
void MapStore::Impl::recover() {
  connect();
  if (database->number("PRAGMA wal_checkpoint(TRUNCATE)") != 0) {
    throw StoreFault{false, file.string() + ": somebody reads it for long; waiting"};
  }
}

void MapStore::Impl::disconnect() {
  writer.reset();
  database.reset();
}

void MapStore::Impl::connect() {
  disconnect();
  database = open_database(file, mode);
  version = prepare(*database, mode);
  if (mode == StoreMode::read_only) return;
  writer.emplace(*database);
  database->fold_log_on_close(true);
}

MapStore::Impl::Content MapStore::Impl::read() {
  const Transaction snapshot(*database, Transaction::Kind::read);
  Content content;
  content.map = read_map(*database, version);
  content.world = read_world(*database, version, content.map.meta.next_landmark);
  return content;
}

CommitReport MapStore::Impl::commit(const MapChange* map, const WorldChange* world) {
  if (suspect) recover();
  if (database->moved()) {
    throw StoreFault{false, file.string() + ": was removed or renamed while in use; put it back, or restart"};
  }
  Transaction transaction(*database, Transaction::Kind::write);
  CommitReport report = writer->write(map, world);
  transaction.commit();
  return report;
}

MapStore::MapStore(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
MapStore::~MapStore() = default;
MapStore::MapStore(MapStore&&) noexcept = default;
MapStore& MapStore::operator=(MapStore&&) noexcept = default;

const std::filesystem::path& MapStore::file() const {
  return impl_->file;
}

Result<MapStore> MapStore::open(const std::filesystem::path& file, StoreMode mode) {
  Result<std::unique_ptr<Impl>> impl = Impl::make(file, mode);
  if (!impl) return impl.error();
  return at_the_door(file, [&] {
    if (mode == StoreMode::read_write) create_if_missing((*impl)->file);
    (*impl)->connect();
    return MapStore(std::move(*impl));
  });
}

// Connects and reads. Damage comes back as what is wrong; the file is then as it was found.
std::optional<std::string> MapStore::Impl::try_read(Content& content) {
  try {
    connect();
    content = read();
    return std::nullopt;
  } catch (const StoreFault& fault) {
    if (!fault.damage) throw;
    if (database) database->fold_log_on_close(false);
    disconnect();
    // SQLite may take a block that the disk does not give for a damaged one.
    expect_readable(file);
    expect_readable(beside(file, "-wal"));
    return fault.message;
  }
}

Result<OpenedStore> open_or_quarantine(const std::filesystem::path& file) {
  Result<std::unique_ptr<MapStore::Impl>> made = MapStore::Impl::make(file, StoreMode::read_write);
  if (!made) return made.error();
  MapStore::Impl& impl = **made;
  return at_the_door(impl.file, [&] {
    MapStore::Impl::Content content;
    std::filesystem::path quarantined;
    create_if_missing(impl.file);
    std::optional<std::string> damage = impl.try_read(content);
    if (damage) damage = impl.try_read(content);  // a disk may stumble once
    if (damage) {
      quarantined = set_aside(impl.file, *damage);
      create_if_missing(impl.file);
      impl.connect();
      content = impl.read();
    }
    return OpenedStore{MapStore(std::move(*made)), std::move(content.map), std::move(content.world),
                       std::move(quarantined)};
  });
}

Result<MapContent> MapStore::load() {
  return at_the_door(impl_->file, [this] {
    const Transaction snapshot(*impl_->database, Transaction::Kind::read);
    return read_map(*impl_->database, impl_->version);
  });
}

Result<WorldContent> MapStore::load_world() {
  return at_the_door(impl_->file, [this] {
    const Transaction snapshot(*impl_->database, Transaction::Kind::read);
    return read_world(*impl_->database, impl_->version, read_meta_row(*impl_->database).map.next_landmark);
  });
}

Result<CommitReport> MapStore::commit(const MapChange* map, const WorldChange* world) {
  EXPECTS(impl_->mode == StoreMode::read_write);
  Result<CommitReport> done = at_the_door(impl_->file, [&] { return impl_->commit(map, world); });
  impl_->suspect = !done;
  return done;
}

Result<StoreInfo> MapStore::info() {
  return at_the_door(impl_->file, [this] {
    const Transaction snapshot(*impl_->database, Transaction::Kind::read);
    const StoredMeta meta = read_meta_row(*impl_->database);
    StoreInfo info;
    info.schema_version = impl_->version;
    info.sqlite_version = sqlite3_libversion();
    info.commits = meta.commits;
    info.created = meta.created;
    info.committed = meta.committed;
    info.meta = meta.map;
    info.world = read_world_meta_row(*impl_->database, impl_->version);
    info.tables = read_totals(*impl_->database, impl_->version);
    std::error_code failed;
    info.file_bytes = std::filesystem::file_size(impl_->file, failed);
    const std::uintmax_t log = std::filesystem::file_size(beside(impl_->file, "-wal"), failed);
    info.log_bytes = failed ? 0 : log;
    return info;
  });
}

}  // namespace povslam
