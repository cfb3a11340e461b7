// Labels over LCM: receives povslam.label_image_t on labels.lcm_channel and hands the labels on, in a thread of its
// own. LCM's door for what comes in.
#pragma once

#include <memory>
#include <string>
#include <thread>

#include "daemon/label_protocol.hpp"
#include "daemon/label_ring.hpp"
#include "daemon/label_silence.hpp"
#include "pipeline/base/result.hpp"

namespace povslam {

struct LcmLabelOptions {
  std::string url;       // lcm.url
  std::string channel;   // labels.lcm_channel
  std::string robot_id;  // messages for others are left alone
  std::string table;     // name of the class table that labels must refer to
  LabelLimits limits;
  int max_messages_per_s = 30;  // more are dropped before they are decoded
  TimeNs silence = kLabelSilence;
};

class LcmLabelThread {
 public:
  // Labels go into `ring`, whose one producer this thread is. Both outlive the thread. Who chooses images adds to
  // counters.offered: that is how silence is known.
  static Result<std::unique_ptr<LcmLabelThread>> start(LcmLabelOptions options, LabelRing& ring,
                                                       LabelSourceCounters& counters);
  ~LcmLabelThread();  // stops and joins, within a quarter of a second

 private:
  struct Impl;
  explicit LcmLabelThread(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
  std::jthread thread_;  // last: stops before what it uses goes
};

}  // namespace povslam
