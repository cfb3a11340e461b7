// The Unix socket (labels.socket) at which an external process fetches images and delivers labels; one at a time, a
// second one is told so. Whatever comes over it is checked before it is believed; who misbehaves is told why and hung
// up on, and after a pause the next may come. Waits only in step(). The protocol: label_protocol.hpp, docs/labels.md.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "daemon/label_client.hpp"
#include "daemon/label_silence.hpp"
#include "pipeline/base/latest.hpp"

namespace povslam {

struct LabelSocketOptions {
  std::string path;
  LabelClientOptions client;
  TimeNs pause = 200 * kNsPerMs;  // after one source left, before the next comes in
  TimeNs silence = kLabelSilence;
};

class LabelSocket {
 public:
  // Listens. A socket that was left behind by a process that is gone is replaced; one that somebody listens at, or a
  // path that cannot be used, is an error.
  static Result<std::unique_ptr<LabelSocket>> open(LabelSocketOptions options, LabelRing& ring,
                                                   LabelSourceCounters& counters);
  ~LabelSocket();  // the path is gone afterwards

  // One thread other than step's, or the same. Keeps a copy as the newest image; never waits.
  void offer(const RgbdFrame& image);
  // Any thread: step() returns soon.
  void wake();

  // Handles what has come, waits for no longer than a second.
  void step();

 private:
  LabelSocket(LabelSocketOptions options, FileDescriptor listener, FileDescriptor wake, LabelRing& ring,
              LabelSourceCounters& counters);
  void wait_for_events(bool& at_door, bool& readable);
  void accept_one(TimeNs now);
  void serve(TimeNs now, bool readable);
  void dismiss(const std::string& reason, TimeNs now);

  LabelSocketOptions options_;
  FileDescriptor listener_, wake_;
  LabelRing& ring_;
  LabelSourceCounters& counters_;
  Latest<RgbdFrame> images_;
  std::optional<LabelClient> client_;
  TimeNs paused_until_ = 0;
  std::string last_reason_;
  LabelSilence silence_;
};

}  // namespace povslam
