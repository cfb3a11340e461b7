#include "daemon/store_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

namespace povslam {

std::filesystem::path beside(const std::filesystem::path& store, const char* ending) {
  return store.string() + ending;
}

Result<StoreLock> StoreLock::take(const std::filesystem::path& store) {
  const std::filesystem::path name = beside(store, ".lock");
  const int file = open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0640);
  if (file < 0) {
    return Error{name.string() + ": " + std::strerror(errno) + "; the folder must be writable by this user"};
  }
  if (flock(file, LOCK_EX | LOCK_NB) == 0) return StoreLock(file);
  const int why = errno;
  close(file);
  if (why != EWOULDBLOCK) return Error{name.string() + ": " + std::strerror(why) + "; is it on a network disk?"};
  return Error{store.string() + ": another povslam process uses this map; stop it (fuser " + name.string() +
               " names it), or name another file"};
}

StoreLock::StoreLock(StoreLock&& other) noexcept : file_(std::exchange(other.file_, -1)) {}

StoreLock& StoreLock::operator=(StoreLock&& other) noexcept {
  std::swap(file_, other.file_);
  return *this;
}

// The file stays: were it removed, two processes could hold locks on two files of its name.
StoreLock::~StoreLock() {
  if (file_ >= 0) close(file_);
}

void sync_folder_of(const std::filesystem::path& file) {
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  const int handle = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (handle < 0) return;
  fsync(handle);
  close(handle);
}

}  // namespace povslam
