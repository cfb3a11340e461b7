// Holds things back for a fixed number of frames: what enters at frame n comes out at frame n + delay, so that one
// thread gives a background job's answer at a frame that does not depend on how fast the machine is.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "pipeline/base/expects.hpp"

namespace povslam {

template <class T>
class DelayLine {
 public:
  explicit DelayLine(std::int64_t delay_frames) : delay_frames_(delay_frames) { EXPECTS(delay_frames > 0); }

  // Frames must not decrease.
  void push(std::int64_t frame, T value) {
    EXPECTS(waiting_.empty() || waiting_.back().due <= frame + delay_frames_);
    waiting_.push_back({frame + delay_frames_, std::move(value)});
  }

  // The next value due at this frame or before, in the order of entry.
  std::optional<T> pop(std::int64_t frame) {
    if (waiting_.empty() || waiting_.front().due > frame) return std::nullopt;
    T value = std::move(waiting_.front().value);
    waiting_.pop_front();
    return value;
  }

 private:
  struct Waiting {
    std::int64_t due;
    T value;
  };
  std::int64_t delay_frames_;
  std::deque<Waiting> waiting_;
};

}  // namespace povslam
