// A disk with a will of its own under SQLite: a VFS that is the default one from construction to destruction.
//
// Power cut: what was written to a file since its last sync is not safe. At the cut each such sector is on the disk or
// not, by dice, or all is lost; the sector being written may be torn. All calls fail from then on until power_on().
// Faults: the n-th write-like call from now fails once, or from then on: disk full, I/O error, short write.
//
// For one thread. Memory-mapped WAL indexes are the real file system's; power_on() removes them, as a reboot would.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <random>

namespace povslam {

enum class DiskFault : std::uint8_t { full, io_error, short_write, failed_sync, read_error };

class FaultyDisk {
 public:
  FaultyDisk();
  ~FaultyDisk();
  FaultyDisk(const FaultyDisk&) = delete;
  FaultyDisk& operator=(const FaultyDisk&) = delete;

  // After `calls` further writes, truncations and syncs the power goes.
  void cut_power_after(int calls);
  // What is left of unsynced writes: nothing, or a random part of them.
  enum class Leftover : std::uint8_t { nothing, a_prefix, any_sectors };
  void power_on(Leftover leftover, std::mt19937& random);
  bool power_is_off() const;

  // After `calls` further calls of the kind that it hits (reads, syncs, or all that write), `times` of them fail.
  void fail_after(int calls, DiskFault fault, int times = 1);
  bool has_failed() const;
  int calls() const;  // writes, truncations and syncs so far

  struct State;

 private:
  std::unique_ptr<State> state_;
};

}  // namespace povslam
