// Frames that never came, by the numbers of those that did.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

namespace povslam {

class GapCounter {
 public:
  // A frame was reported as bad: it is counted as that, not as missing too.
  void bad() { ++bad_; }
  // How many are missing between the last frame and this one; none before the first.
  std::int64_t missing_before(std::uint64_t seq) {
    const std::uint64_t between = last_ && seq > *last_ + 1 ? seq - *last_ - 1 : 0;
    const std::uint64_t missing = between - std::min(between, bad_);
    last_ = seq;
    bad_ = 0;
    return static_cast<std::int64_t>(missing);
  }
  void reset() { *this = {}; }  // the device was opened anew, the count begins again

 private:
  std::optional<std::uint64_t> last_;
  std::uint64_t bad_ = 0;
};

}  // namespace povslam
