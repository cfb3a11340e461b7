// Bounded hand-off from exactly one producer thread to exactly one consumer thread.
// Lock-free and allocation-free after construction (boost::lockfree::spsc_queue); an empty ring is waited
// for on a futex (C++20 atomic wait), never by spinning. When full, try_push refuses: the caller counts the drop.
// Values are moved in and out. The queue itself copies its elements, so it carries the numbers of slots.
// Rings that share a Doorbell can be waited for together:
//
//   for (;;) {
//     const std::uint32_t rung = bell.count();
//     …try_pop from each ring…
//     bell.wait(rung);  // returns at once when one was pushed to, or closed, since count()
//   }
#pragma once

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "pipeline/base/expects.hpp"

namespace povslam {

// Any threads ring, one waits.
class Doorbell {
 public:
  void ring() {
    count_.fetch_add(1, std::memory_order_seq_cst);  // before the look for a sleeper inside notify_one
    count_.notify_one();
  }
  std::uint32_t count() const { return count_.load(std::memory_order_acquire); }
  void wait(std::uint32_t rung) const { count_.wait(rung, std::memory_order_acquire); }

 private:
  alignas(64) std::atomic<std::uint32_t> count_{0};
};

template <class T>
class SpscRing {
  static_assert(std::is_nothrow_move_constructible_v<T>);

 public:
  // bell: rung with each push and on closing, for a consumer that waits for more than this ring; outlives it.
  explicit SpscRing(std::size_t capacity, Doorbell* bell = nullptr) : slots_(capacity), queue_(capacity), bell_(bell) {
    EXPECTS(capacity > 0);
  }
  SpscRing(const SpscRing&) = delete;
  SpscRing& operator=(const SpscRing&) = delete;

  // Producer thread. False when full or closed; the value is then left untouched.
  bool try_push(T&& value) {
    if (closed_.load(std::memory_order_acquire)) return false;
    if (queue_.write_available() == 0) return false;  // room for a number means its slot was moved from
    slots_[next_].emplace(std::move(value));
    queue_.push(next_);
    next_ = next_ + 1 == slots_.size() ? 0 : next_ + 1;
    signal();
    return true;
  }

  // Consumer thread. Nothing when empty at this moment.
  std::optional<T> try_pop() {
    std::optional<T> value;
    queue_.consume_one([&](std::size_t slot) {  // the slot is the producer's again only after this returns
      value.emplace(std::move(*slots_[slot]));
    });
    return value;
  }

  // Consumer thread. Sleeps until a value comes; nothing once the ring is closed and empty.
  std::optional<T> pop() {
    for (;;) {
      const std::uint32_t seen = own_.count();
      if (auto value = try_pop()) return value;
      if (closed_.load(std::memory_order_acquire)) return try_pop();
      own_.wait(seen);
    }
  }

  // Any thread. Wakes the consumer; values already inside can still be popped. A push that runs at the same moment may
  // succeed after the consumer saw the end: who counts every value calls try_pop once more after the producer ended.
  void close() {
    closed_.store(true, std::memory_order_release);
    signal();
  }
  bool closed() const { return closed_.load(std::memory_order_acquire); }

  std::size_t size() const { return queue_.read_available(); }  // exact on the consumer thread
  std::size_t capacity() const { return slots_.size(); }

 private:
  void signal() {
    own_.ring();
    if (bell_ != nullptr) bell_->ring();
  }

  std::vector<std::optional<T>> slots_;
  boost::lockfree::spsc_queue<std::size_t> queue_;
  std::size_t next_ = 0;  // slot the producer fills next
  Doorbell own_;
  std::atomic<bool> closed_{false};
  Doorbell* bell_;
};

}  // namespace povslam
