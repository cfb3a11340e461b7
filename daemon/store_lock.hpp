// One writer at a time: an flock on a file beside the store. It goes with its process, however that ends.
#pragma once

#include <filesystem>

#include "pipeline/base/result.hpp"

namespace povslam {

class StoreLock {
 public:
  // Fails when another process (or another store of this one) holds it, or the file cannot be made.
  static Result<StoreLock> take(const std::filesystem::path& store);
  ~StoreLock();
  StoreLock(StoreLock&& other) noexcept;
  StoreLock& operator=(StoreLock&& other) noexcept;

 private:
  explicit StoreLock(int file) : file_(file) {}
  int file_ = -1;
};

// The store's own files beside it: "", "-wal", "-shm"; and ".lock".
std::filesystem::path beside(const std::filesystem::path& store, const char* ending);

// A store that is renamed or made is so on the disk as well. Best effort: a file system that cannot sync a folder.
void sync_folder_of(const std::filesystem::path& file);

}  // namespace povslam
