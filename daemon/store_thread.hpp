// The store thread: commits what became of the map and of what stands in it, beside tracking and understanding. What is
// there of both goes into one commit. A commit that fails is tried again for ever with growing pauses; meanwhile the
// change waits, its owner collects what comes after it, and nothing is forgotten.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "daemon/change_rings.hpp"
#include "daemon/counters.hpp"
#include "daemon/store.hpp"

namespace povslam {

struct StoreThreadOptions {
  TimeNs first_pause = kNsPerSecond;  // before trying again; doubles up to
  TimeNs longest_pause = 30 * kNsPerSecond;
};

class StoreThread {
 public:
  // Commits what is taken and gives it back as stored once it is on the disk. Counters say how it goes.
  StoreThread(MapStore store, ChangeRings& changes, Counters& counters, const StoreThreadOptions& options = {});
  ~StoreThread();  // as finish()

  StoreThread(const StoreThread&) = delete;
  StoreThread& operator=(const StoreThread&) = delete;

  // Once nobody hands over changes any more: ends the thread. What it was given is tried once more at most; true: all
  // of it is on the disk.
  bool finish();
  // After finish() was true: what the owners still had, on the calling thread; null: nothing.
  bool commit_rest(const MapChange* map, const WorldChange* world);

 private:
  void run(const std::stop_token& stop);
  bool commit(const MapChange* map, const WorldChange* world);
  void note(const Result<CommitReport>& done);
  void pause(const std::stop_token& stop, TimeNs duration);

  MapStore store_;
  ChangeRings& changes_;
  Counters& counters_;
  StoreThreadOptions options_;
  bool failing_ = false;        // the thread's; after finish(): something is not on the disk
  bool told_left_out_ = false;  // the thread's
  TimeNs failing_since_ = 0;    // monotonic

  std::mutex pause_mutex_;
  std::condition_variable_any pause_;
  std::jthread thread_;  // last: stops before what it uses goes
};

}  // namespace povslam
