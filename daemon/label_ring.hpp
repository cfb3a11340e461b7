// Labels from outside the daemon on their way to the understanding thread. Each source (socket, LCM, the
// sensor) has a ring of its own: a ring has one producer.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

#include "pipeline/base/spsc_ring.hpp"
#include "pipeline/frames/label_frame.hpp"

namespace povslam {

using LabelRing = SpscRing<LabelFrame>;
inline constexpr std::size_t kLabelRing = 8;  // label frames; what finds no room is dropped and counted

inline constexpr TimeNs kLabelSilence = 5 * kNsPerSecond;  // a source that leaves images unanswered so long is silent

// What a source counts; any thread reads.
struct LabelSourceCounters {
  std::atomic<std::int64_t> offered{0};  // images that could be labelled
  std::atomic<std::int64_t> images{0};   // of these, sent to a source
  std::atomic<std::int64_t> labels{0};   // label frames handed on
  std::atomic<std::int64_t> dropped{0};  // label frames for which the ring had no room
  std::atomic<std::int64_t> bad{0};      // messages that were refused
  std::atomic<std::int64_t> clients{0};  // connections that said hello
  std::atomic<bool> connected{false};
  std::atomic<bool> silent{false};  // images came, labels did not, for kLabelSilence
};

struct LabelSourceHealth {  // the same as plain values
  std::string name;
  bool connected = false, silent = false;
  std::int64_t offered = 0, images = 0, labels = 0, dropped = 0, bad = 0;
};

}  // namespace povslam
