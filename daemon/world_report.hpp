// What the understanding thread tells the reporter.
#pragma once

#include <variant>
#include <vector>

#include "daemon/label_ring.hpp"
#include "pipeline/base/spsc_ring.hpp"
#include "pipeline/objects/object_event.hpp"
#include "pipeline/understanding.hpp"

namespace povslam {

struct ObjectSnapshot {
  TimeNs stamp = 0;                   // of the last view understood; 0: none yet
  std::vector<ObjectRecord> objects;  // that stand: the confirmed ones
};

// After each view, and once more at the end.
struct UnderstandingNews {
  std::int64_t views_understood = 0;
  std::int64_t events = 0;  // made since the start
  int objects = 0;          // that stand
  float total_ms = -1.0F;   // of this view; < 0: it was none
  LabelCounts labels;
  std::vector<LabelSourceHealth> label_sources;  // outside the daemon
  NamingCounts naming;
  float naming_ms = 0.0F;  // CPU of the network's last look
};

using WorldReport = std::variant<ObjectEvent, ObjectSnapshot, UnderstandingNews>;
using ReportRing = SpscRing<WorldReport>;

// "object 12 (box) moved from (1.00, 2.00, 0.40) to (1.00, 5.00, 0.40) m, probability 0.97"
std::string to_text(const ObjectEvent& event);

}  // namespace povslam
