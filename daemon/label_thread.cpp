#include "daemon/label_thread.hpp"

#include <utility>

#include "daemon/thread_name.hpp"

namespace povslam {

Result<std::unique_ptr<LabelThread>> LabelThread::start(LabelSocketOptions options, LabelRing& ring,
                                                        LabelSourceCounters& counters) {
  Result<std::unique_ptr<LabelSocket>> socket = LabelSocket::open(std::move(options), ring, counters);
  if (!socket) return socket.error();
  return std::unique_ptr<LabelThread>(new LabelThread(std::move(*socket)));
}

LabelThread::LabelThread(std::unique_ptr<LabelSocket> socket) : socket_(std::move(socket)) {
  thread_ = std::jthread([this](const std::stop_token& stop) {
    name_this_thread("labels");
    while (!stop.stop_requested()) socket_->step();
  });
}

LabelThread::~LabelThread() {
  thread_.request_stop();
  socket_->wake();
}

}  // namespace povslam
