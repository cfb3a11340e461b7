// What the daemon's threads count: each counter has one writer or is added to atomically, any thread reads.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "pipeline/base/time.hpp"

namespace povslam {

enum class DropReason : std::uint8_t { ring_full, bad_frame, gap, late, unused, publisher };  // see drop_t.lcm
inline constexpr std::size_t kNumDropReasons = 6;
const char* to_string(DropReason reason);

struct JobCounters {
  std::atomic<std::int64_t> runs{0};
  std::atomic<TimeNs> last{0};  // duration of the last run
};

struct Counters {
  std::atomic<std::int64_t> frames_in{0};  // whole frames from drivers
  std::atomic<std::int64_t> tracked{0};    // state ok or degraded
  std::atomic<std::int64_t> lost{0};       // any other state
  std::array<std::atomic<std::int64_t>, kNumDropReasons> drops{};
  std::atomic<std::int64_t> reopened{0};
  std::atomic<int> sensors_up{0};
  JobCounters backend, vem;
  std::atomic<bool> store_used{false};      // the map is kept on disk
  std::atomic<bool> store_replaced{false};  // what was on the disk was damaged: the map began empty
  std::atomic<bool> store_failing{false};   // the last commit failed
  std::atomic<std::int64_t> store_commits{0};
  std::atomic<TimeNs> store_committed_at{0};    // monotonic, of the last one; 0: none yet
  std::atomic<TimeNs> store_last{0};            // duration of the last one
  std::atomic<std::int64_t> views{0};           // frames handed to understanding
  std::atomic<std::int64_t> views_dropped{0};   // that it was too slow to take
  std::atomic<std::int64_t> labels_dropped{0};  // likewise
  std::atomic<TimeNs> feeder_cpu{0};            // CPU of the sensor thread
  std::atomic<TimeNs> tracking_cpu{0};          // CPU of the tracking thread

  void drop(DropReason reason, std::int64_t count = 1) {
    drops[static_cast<std::size_t>(reason)].fetch_add(count, std::memory_order_relaxed);
  }
  std::int64_t dropped(DropReason reason) const {
    return drops[static_cast<std::size_t>(reason)].load(std::memory_order_relaxed);
  }
};

}  // namespace povslam
