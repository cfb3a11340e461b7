#include "daemon/backend_thread.hpp"

#include <utility>

#include "daemon/thread_name.hpp"

namespace povslam {

BackendThread::BackendThread(const char* name, SpscRing<BackendJob>& asked, SpscRing<BackendJob>& solved,
                             const BackendOptions& options, JobCounters& counters)
    : name_(name),
      asked_(asked),
      solved_(solved),
      options_(options),
      counters_(counters),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

BackendThread::~BackendThread() {
  thread_.request_stop();
  asked_.close();
  thread_.join();
}

void BackendThread::run(const std::stop_token& stop) {
  name_this_thread(name_);
  while (auto job = asked_.pop()) {
    if (stop.stop_requested()) return;
    const TimeNs begun = monotonic_now();
    solve(*job, options_);
    counters_.last.store(monotonic_now() - begun, std::memory_order_relaxed);
    counters_.runs.fetch_add(1, std::memory_order_relaxed);
    const bool taken = solved_.try_push(std::move(*job));
    EXPECTS(taken);  // the ring holds as many as can be asked for at once
  }
}

}  // namespace povslam
