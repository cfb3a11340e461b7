#include "daemon/stop_signal.hpp"

#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <array>
#include <csignal>

#include "pipeline/base/expects.hpp"

namespace povslam {

StopSignal::StopSignal() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGINT);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  signals_ = signalfd(-1, &set, SFD_CLOEXEC);
  request_ = eventfd(0, EFD_CLOEXEC);
  EXPECTS(signals_ >= 0 && request_ >= 0);
}

StopSignal::~StopSignal() {
  close(signals_);
  close(request_);
}

void StopSignal::request() {
  EXPECTS(eventfd_write(request_, 1) == 0);
}

void StopSignal::wait() {
  while (!poll_for(-1)) {
  }
}

bool StopSignal::stopped() {
  return poll_for(0);
}

bool StopSignal::poll_for(int timeout_ms) {
  std::array<pollfd, 2> fds{pollfd{signals_, POLLIN, 0}, pollfd{request_, POLLIN, 0}};
  return poll(fds.data(), fds.size(), timeout_ms) > 0;
}

}  // namespace povslam
