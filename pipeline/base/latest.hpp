// Mailbox that holds the latest value only: one writer thread, one reader thread, both wait-free.
// Three slots: the writer fills its own and swaps it with the middle, the reader swaps the middle with its own.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace povslam {

template <class T>
class Latest {
 public:
  Latest() = default;
  explicit Latest(const T& prototype) : slots_{prototype, prototype, prototype} {}  // sizes the slots' buffers once
  Latest(const Latest&) = delete;
  Latest& operator=(const Latest&) = delete;

  // Writer thread: fill draft(), then publish(). A value not yet read is replaced. The draft holds some older value,
  // so write all of it; references to it end with publish().
  T& draft() { return slots_[write_]; }
  void publish() { write_ = middle_.exchange(write_ | kFresh, std::memory_order_acq_rel) & kIndex; }

  // Reader thread: the newest value not seen before, or null. Valid until the next call.
  T* take() {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return nullptr;
    read_ = middle_.exchange(read_, std::memory_order_acq_rel) & kIndex;
    return &slots_[read_];
  }

 private:
  static constexpr std::uint32_t kIndex = 3;
  static constexpr std::uint32_t kFresh = 4;
  std::array<T, 3> slots_{};
  std::uint32_t write_ = 0;
  alignas(64) std::atomic<std::uint32_t> middle_{1};
  alignas(64) std::uint32_t read_ = 2;
};

}  // namespace povslam
