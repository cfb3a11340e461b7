// The replay driver's options, checked.
#pragma once

#include "drivers/driver.hpp"
#include "drivers/replay/sequence.hpp"

namespace povslam {

struct ReplayOptions {
  SequenceOptions sequence;
  FrameRange frames;
  bool realtime = false;
};

Result<ReplayOptions> parse_replay_options(const DriverOptions& options);

}  // namespace povslam
