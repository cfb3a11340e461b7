// Frames between one sensor thread and the tracking thread: a fixed pool of slots, handed over by index, so that
// nothing is allocated or copied per frame. The sensor always owns one slot to write into, which keeps its device
// drained even when tracking is behind.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/base/spsc_ring.hpp"
#include "pipeline/frames/sensor_frame.hpp"

namespace povslam {

class FrameExchange {
 public:
  explicit FrameExchange(int num_slots)
      : slots_(static_cast<std::size_t>(num_slots)), filled_(slots_.size()), empty_(slots_.size()) {
    EXPECTS(num_slots >= 2);
    for (int slot = 1; slot < num_slots; ++slot) empty_.try_push(int{slot});
  }

  // Sensor thread. The frame to write into; stays the same until submitted.
  SensorFrame& draft() { return slots_[static_cast<std::size_t>(draft_)]; }
  // Sensor thread. Hands the draft over; false when no empty slot is left to go on with: the draft is then kept.
  bool try_submit() { return submit(empty_.try_pop()); }
  // The same, but waits for an empty slot (a recording read as fast as possible). Needs a living consumer.
  bool submit_when_possible() { return submit(empty_.pop()); }

  // Tracking thread. Sleeps until a frame comes; null once closed and empty. Give it back before the next one.
  SensorFrame* take() {
    const std::optional<int> slot = filled_.pop();
    if (!slot) return nullptr;
    taken_ = *slot;
    return &slots_[static_cast<std::size_t>(taken_)];
  }
  void give_back() { empty_.try_push(int{taken_}); }

  // Any thread. No more frames will come; those inside can still be taken.
  void close() { filled_.close(); }
  bool waiting() const { return filled_.size() > 0; }  // a frame is inside

 private:
  bool submit(std::optional<int> next) {
    if (!next) return false;
    filled_.try_push(int{draft_});
    draft_ = *next;
    return true;
  }

  std::vector<SensorFrame> slots_;
  SpscRing<int> filled_;  // sensor -> tracking
  SpscRing<int> empty_;   // tracking -> sensor
  int draft_ = 0;         // sensor thread
  int taken_ = 0;         // tracking thread
};

}  // namespace povslam
