// The thread of the label socket: povslamd's side of an external label source (docs/labels.md).
#pragma once

#include <memory>
#include <thread>

#include "daemon/label_socket.hpp"

namespace povslam {

class LabelThread {
 public:
  // Labels go into `ring`, whose one producer this thread is. Both outlive the thread.
  static Result<std::unique_ptr<LabelThread>> start(LabelSocketOptions options, LabelRing& ring,
                                                    LabelSourceCounters& counters);
  ~LabelThread();  // stops, joins, hangs up

  // From one thread: this image may be labelled; it replaces one that was not fetched yet. Copies, never waits.
  void offer(const RgbdFrame& image) { socket_->offer(image); }

 private:
  explicit LabelThread(std::unique_ptr<LabelSocket> socket);

  std::unique_ptr<LabelSocket> socket_;
  std::jthread thread_;  // last: stops before what it uses goes
};

}  // namespace povslam
