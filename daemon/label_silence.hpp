// Whether a label source leaves images unanswered: images are offered, labels do not come. Says so once in the log, and
// once when they come again.
#pragma once

#include <string>

#include "daemon/label_ring.hpp"
#include "pipeline/base/log.hpp"
#include "pipeline/base/time.hpp"

namespace povslam {

class LabelSilence {
 public:
  LabelSilence(std::string source, TimeNs longest) : source_(std::move(source)), longest_(longest) {}

  // From the thread of the source, at least a few times in `longest`.
  void watch(LabelSourceCounters& counters, TimeNs now) {
    const std::int64_t labels = counters.labels.load(std::memory_order_relaxed);
    const std::int64_t offered = counters.offered.load(std::memory_order_relaxed);
    if (labels != labels_) unanswered_since_ = 0;
    if (offered != offered_ && unanswered_since_ == 0) unanswered_since_ = now;
    labels_ = labels;
    offered_ = offered;
    const bool silent = unanswered_since_ != 0 && now - unanswered_since_ > longest_;
    if (silent == counters.silent.exchange(silent, std::memory_order_relaxed)) return;
    if (silent) {
      log::warn("labels: none for {:.0f} s from {}", to_seconds(longest_), source_);
    } else {
      log::info("labels: they come again from {}", source_);
    }
  }

 private:
  std::string source_;
  TimeNs longest_;
  std::int64_t offered_ = 0, labels_ = 0;
  TimeNs unanswered_since_ = 0;  // 0: nothing is
};

}  // namespace povslam
