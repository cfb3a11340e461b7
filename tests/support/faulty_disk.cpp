#include "tests/support/faulty_disk.hpp"

#include <sqlite3.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "pipeline/base/expects.hpp"

namespace povslam {
namespace {

constexpr std::size_t kSector = 512;  // what a disk writes whole, or tears when the power goes in the middle

struct Write {
  std::size_t offset = 0;
  std::string bytes;        // of a write; a truncation has none…
  bool truncation = false;  // …and makes the file as long as `offset`
};

// A file as it is safe on the disk, and what was done to it since.
struct Shadow {
  std::string name;
  std::string safe;
  bool exists_safely = false;
  std::vector<Write> pending;
};

void carry_out(const Write& write, std::string& content) {
  if (write.truncation) {
    content.resize(write.offset);
    return;
  }
  if (content.size() < write.offset + write.bytes.size()) content.resize(write.offset + write.bytes.size());
  content.replace(write.offset, write.bytes.size(), write.bytes);
}

ino_t inode(const std::string& name) {
  struct stat about {};
  return stat(name.c_str(), &about) == 0 ? about.st_ino : 0;
}

std::string read_file(const std::string& name) {
  std::ifstream file(name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

struct FaultyDisk::State {
  sqlite3_vfs vfs{};
  sqlite3_vfs* real = nullptr;
  std::map<ino_t, Shadow> files;  // a renamed file is the same one
  bool off = false;
  int until_cut = -1;  // calls; < 0: never
  int until_fault = -1, faults = 0;
  DiskFault fault = DiskFault::full;
  bool failed = false;
  int calls = 0;

  Shadow& shadow(const std::string& name) { return files[inode(name)]; }
  // Of one more call that writes: true, the power is off.
  bool count_and_maybe_cut() {
    ++calls;
    if (!off && until_cut >= 0 && until_cut-- == 0) off = true;
    return off;
  }
  enum class Call : std::uint8_t { read, write, sync };
  bool fault_hits(Call call) {
    const bool meant = fault == DiskFault::read_error    ? call == Call::read
                       : fault == DiskFault::failed_sync ? call == Call::sync
                                                         : call != Call::read;
    if (until_fault < 0 || !meant) return false;
    if (until_fault > 0) {
      --until_fault;
      return false;
    }
    if (faults == 0) {
      until_fault = -1;
      return false;
    }
    --faults;
    failed = true;
    return true;
  }
};

namespace {

FaultyDisk::State* disk = nullptr;  // the one that lives

struct File {
  sqlite3_file base;
  const char* name;  // null: a temporary file, which nobody misses
  sqlite3_file* real;
};

File& as_file(sqlite3_file* file) {
  return *reinterpret_cast<File*>(file);
}

sqlite3_file* real_of(sqlite3_file* file) {
  return as_file(file).real;
}

int write_fault() {
  return disk->fault == DiskFault::full ? SQLITE_FULL : SQLITE_IOERR_WRITE;
}

int x_close(sqlite3_file* file) {
  return real_of(file)->pMethods->xClose(real_of(file));
}
int x_read(sqlite3_file* file, void* out, int size, sqlite3_int64 offset) {
  if (disk->off || disk->fault_hits(FaultyDisk::State::Call::read)) return SQLITE_IOERR_READ;
  File& f = as_file(file);
  return f.real->pMethods->xRead(f.real, out, size, offset);
}
int x_write(sqlite3_file* file, const void* bytes, int size, sqlite3_int64 offset) {
  File& f = as_file(file);
  int written = size;
  int code = SQLITE_OK;
  if (disk->fault_hits(FaultyDisk::State::Call::write)) {
    code = write_fault();
    written = disk->fault == DiskFault::short_write ? size / 3 : 0;
  }
  const bool before = disk->off;
  if (f.name != nullptr && !before && written > 0) {
    disk->shadow(f.name).pending.push_back(
        {static_cast<std::size_t>(offset),
         std::string(static_cast<const char*>(bytes), static_cast<std::size_t>(written)), false});
  }
  if (disk->count_and_maybe_cut()) return SQLITE_IOERR_WRITE;  // the write at the cut is one of those in doubt
  if (written > 0) {
    const int real_code = f.real->pMethods->xWrite(f.real, bytes, written, offset);
    if (real_code != SQLITE_OK) return real_code;
  }
  return code;
}
int x_truncate(sqlite3_file* file, sqlite3_int64 size) {
  File& f = as_file(file);
  if (disk->fault_hits(FaultyDisk::State::Call::write)) return SQLITE_IOERR_TRUNCATE;
  if (f.name != nullptr && !disk->off)
    disk->shadow(f.name).pending.push_back({static_cast<std::size_t>(size), "", true});
  if (disk->count_and_maybe_cut()) return SQLITE_IOERR_TRUNCATE;
  return f.real->pMethods->xTruncate(f.real, size);
}
int x_sync(sqlite3_file* file, int /*flags*/) {
  File& f = as_file(file);
  if (disk->fault_hits(FaultyDisk::State::Call::sync)) {
    // What could not be written back is forgotten although reading still shows it: a later sync does not bring it.
    if (f.name != nullptr) disk->shadow(f.name).pending.clear();
    return SQLITE_IOERR_FSYNC;
  }
  if (disk->count_and_maybe_cut()) return SQLITE_IOERR_FSYNC;
  if (f.name != nullptr) {
    Shadow& shadow = disk->shadow(f.name);
    for (const Write& write : shadow.pending) carry_out(write, shadow.safe);
    shadow.pending.clear();
    shadow.exists_safely = true;
  }
  return SQLITE_OK;  // the shadow is what counts: real syncs would only take time
}
int x_size(sqlite3_file* file, sqlite3_int64* size) {
  if (disk->off) return SQLITE_IOERR_FSTAT;
  File& f = as_file(file);
  return f.real->pMethods->xFileSize(f.real, size);
}

// The rest is passed on.
int x_lock(sqlite3_file* f, int level) {
  return real_of(f)->pMethods->xLock(real_of(f), level);
}
int x_unlock(sqlite3_file* f, int level) {
  return real_of(f)->pMethods->xUnlock(real_of(f), level);
}
int x_check_lock(sqlite3_file* f, int* out) {
  return real_of(f)->pMethods->xCheckReservedLock(real_of(f), out);
}
int x_control(sqlite3_file* f, int op, void* argument) {
  // Sizes and times of the real file system must not go past this one.
  if (op == SQLITE_FCNTL_SIZE_HINT || op == SQLITE_FCNTL_CHUNK_SIZE) return SQLITE_OK;
  return real_of(f)->pMethods->xFileControl(real_of(f), op, argument);
}
int x_sector(sqlite3_file* /*f*/) {
  return kSector;
}
int x_characteristics(sqlite3_file* f) {
  return real_of(f)->pMethods->xDeviceCharacteristics(real_of(f));
}
int x_shm_map(sqlite3_file* f, int page, int size, int extend, void volatile** out) {
  return real_of(f)->pMethods->xShmMap(real_of(f), page, size, extend, out);
}
int x_shm_lock(sqlite3_file* f, int offset, int n, int flags) {
  return real_of(f)->pMethods->xShmLock(real_of(f), offset, n, flags);
}
void x_shm_barrier(sqlite3_file* f) {
  real_of(f)->pMethods->xShmBarrier(real_of(f));
}
int x_shm_unmap(sqlite3_file* f, int remove) {
  return real_of(f)->pMethods->xShmUnmap(real_of(f), remove);
}

const sqlite3_io_methods kMethods = {
    2,           x_close,      x_read,    x_write,  x_truncate,        x_sync,    x_size,     x_lock,
    x_unlock,    x_check_lock, x_control, x_sector, x_characteristics, x_shm_map, x_shm_lock, x_shm_barrier,
    x_shm_unmap, nullptr,      nullptr};

int x_open(sqlite3_vfs* /*vfs*/, sqlite3_filename name, sqlite3_file* file, int flags, int* out_flags) {
  File& f = as_file(file);
  f.base.pMethods = nullptr;
  f.name = name;
  f.real = reinterpret_cast<sqlite3_file*>(reinterpret_cast<char*>(file) + sizeof(File));
  if (disk->off) return SQLITE_CANTOPEN;
  const bool was_there = name != nullptr && inode(name) != 0;
  const int code = disk->real->xOpen(disk->real, name, f.real, flags, out_flags);
  if (f.real->pMethods != nullptr) f.base.pMethods = &kMethods;
  if (code == SQLITE_OK && name != nullptr) {
    const auto [place, is_new] = disk->files.try_emplace(inode(name));
    place->second.name = name;
    if (is_new) {  // what lay there before is safe
      place->second.safe = read_file(name);
      place->second.exists_safely = was_there;
    }
  }
  return code;
}
// Gone for good at once: a file system that keeps its order may do so, and nothing here relies on a file coming back.
int x_delete(sqlite3_vfs* /*vfs*/, const char* name, int sync_folder) {
  if (disk->count_and_maybe_cut()) return SQLITE_IOERR_DELETE;
  disk->files.erase(inode(name));
  return disk->real->xDelete(disk->real, name, sync_folder);
}
int x_access(sqlite3_vfs* /*vfs*/, const char* name, int flags, int* out) {
  if (disk->off) return SQLITE_IOERR_ACCESS;
  return disk->real->xAccess(disk->real, name, flags, out);
}

}  // namespace

FaultyDisk::FaultyDisk() : state_(std::make_unique<State>()) {
  EXPECTS(disk == nullptr);
  sqlite3_initialize();
  state_->real = sqlite3_vfs_find(nullptr);
  state_->vfs = *state_->real;
  state_->vfs.zName = "faulty";
  state_->vfs.szOsFile = static_cast<int>(sizeof(File)) + state_->real->szOsFile;
  state_->vfs.xOpen = x_open;
  state_->vfs.xDelete = x_delete;
  state_->vfs.xAccess = x_access;
  disk = state_.get();
  EXPECTS(sqlite3_vfs_register(&state_->vfs, 1) == SQLITE_OK);
}

FaultyDisk::~FaultyDisk() {
  sqlite3_vfs_register(state_->real, 1);
  sqlite3_vfs_unregister(&state_->vfs);
  disk = nullptr;
}

void FaultyDisk::cut_power_after(int calls) {
  state_->until_cut = calls;
}

bool FaultyDisk::power_is_off() const {
  return state_->off;
}

namespace {

// The file as the disk has it when the power is back.
std::string leftover_of(const Shadow& shadow, FaultyDisk::Leftover leftover, std::mt19937& random) {
  std::string content = shadow.safe;
  const auto dice = [&random](std::size_t sides) {
    return std::uniform_int_distribution<std::size_t>(0, sides - 1)(random);
  };
  if (leftover == FaultyDisk::Leftover::nothing || shadow.pending.empty()) return content;
  if (leftover == FaultyDisk::Leftover::a_prefix) {
    const std::size_t whole = dice(shadow.pending.size());
    for (std::size_t i = 0; i < whole; ++i) carry_out(shadow.pending[i], content);
    Write torn = shadow.pending[whole];  // up to somewhere within
    if (!torn.truncation) torn.bytes.resize(dice(torn.bytes.size() + 1));
    carry_out(torn, content);
    return content;
  }
  for (const Write& write : shadow.pending) {
    if (write.truncation) {
      if (dice(2) == 0) carry_out(write, content);
      continue;
    }
    for (std::size_t at = 0; at < write.bytes.size();) {
      const std::size_t size = std::min(write.bytes.size() - at, kSector - (write.offset + at) % kSector);
      Write part{write.offset + at, write.bytes.substr(at, size), false};
      if (dice(8) == 0) part.bytes.resize(dice(size + 1));  // torn
      if (dice(2) == 0 && !part.bytes.empty()) carry_out(part, content);
      at += size;
    }
  }
  return content;
}

}  // namespace

void FaultyDisk::power_on(Leftover leftover, std::mt19937& random) {
  for (const auto& [number, shadow] : state_->files) {
    const std::string& name = shadow.name;
    if (inode(name) != number) continue;  // renamed and not seen since
    std::filesystem::remove(name + "-shm");
    if (!shadow.exists_safely && leftover == Leftover::nothing) {
      std::filesystem::remove(name);
    } else if (std::filesystem::exists(name)) {
      std::ofstream(name, std::ios::binary) << leftover_of(shadow, leftover, random);
    }
  }
  state_->files.clear();
  state_->off = false;
  state_->until_cut = state_->until_fault = -1;
}

void FaultyDisk::fail_after(int calls, DiskFault fault, int times) {
  state_->until_fault = calls;
  state_->fault = fault;
  state_->faults = times;
  state_->failed = false;
}

bool FaultyDisk::has_failed() const {
  return state_->failed;
}

int FaultyDisk::calls() const {
  return state_->calls;
}

}  // namespace povslam
