// The map on disk: one SQLite file that always holds a whole state of the map. What was committed stays whatever
// happens to the process; a file whose content is not what was written is never believed.
//
//   auto opened = open_or_quarantine(file);   opened->content: the map so far; opened->world: what stands in it
//   each few seconds:  opened->store.commit(map_change, world_change);
//
// One MapStore writes at a time (a lock file beside the store says so); any number may read beside it. An object
// belongs to one thread at a time. Rows of a table are checked one by one (CRC-32C) and as a whole (how many, and
// which).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/base/result.hpp"
#include "pipeline/frontend/map_rows.hpp"
#include "pipeline/objects/world_rows.hpp"

namespace povslam {

enum class StoreMode : std::uint8_t { read_write, read_only };

struct StoreInfo {
  int schema_version = 0;
  std::string sqlite_version;
  std::uint64_t commits = 0;
  TimeNs created = 0, committed = 0;  // wall clock; of the store, of the last commit
  MapMeta meta;
  WorldMeta world;
  std::uintmax_t file_bytes = 0, log_bytes = 0;  // the log: committed, not yet brought into the file
  struct Rows {
    const char* table;
    std::uint64_t rows, bytes;
  };
  std::vector<Rows> tables;
};

struct CommitReport {
  std::uint64_t number = 0;  // of the commit, counted since the store was made
  int rows_left_out = 0;     // whose values cannot be (a pose that is not a number): the older row stays
  std::string why_left_out;  // of the first of them
};

class MapStore {
 public:
  // read_write: makes folder and store when they are not there, brings an older store forward. Damage is an error here.
  static Result<MapStore> open(const std::filesystem::path& file, StoreMode mode);
  ~MapStore();
  MapStore(MapStore&&) noexcept;
  MapStore& operator=(MapStore&&) noexcept;

  // The whole as of the last commit, everything that is read checked. What lost its other half (features without their
  // keyframe, a landmark without its anchor, voxels without their object) is left out.
  Result<MapContent> load();
  Result<WorldContent> load_world();

  // All of the change or nothing; on the disk (fsync) when it returns. Both together are one change. What is both set
  // and removed is removed. Failed: nothing changed, try the same again later.
  Result<CommitReport> commit(const MapChange& map) { return commit(&map, nullptr); }
  Result<CommitReport> commit(const WorldChange& world) { return commit(nullptr, &world); }
  Result<CommitReport> commit(const MapChange* map, const WorldChange* world);  // null: nothing of that kind

  // Reads the whole store, as loading does.
  Result<StoreInfo> info();

  const std::filesystem::path& file() const;

 private:
  struct Impl;
  friend Result<struct OpenedStore> open_or_quarantine(const std::filesystem::path& file);
  explicit MapStore(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

struct OpenedStore {
  MapStore store;
  MapContent content;
  WorldContent world;
  std::filesystem::path quarantined;  // what the damaged store is called now; empty: it was not
};

// Opens for writing and loads. A damaged or foreign file is renamed aside with its log (FILE.damaged-<UTC time>; the
// newest three stay), loudly, and an empty store takes its place. Not damage, so an error: another process holds it, it
// is of a newer povslam, the disk fails or is full, permissions.
Result<OpenedStore> open_or_quarantine(const std::filesystem::path& file);

}  // namespace povslam
