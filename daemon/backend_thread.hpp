// A thread that solves what the pipeline asks beside tracking: one for the map, one for windows of variational EM,
// which must not wait for a long bundle adjustment.
#pragma once

#include <thread>

#include "daemon/counters.hpp"
#include "pipeline/backend_job.hpp"
#include "pipeline/base/spsc_ring.hpp"

namespace povslam {

class BackendThread {
 public:
  // name: of the thread, a literal.
  BackendThread(const char* name, SpscRing<BackendJob>& asked, SpscRing<BackendJob>& solved,
                const BackendOptions& options, JobCounters& counters);
  ~BackendThread();  // closes `asked`, finishes the problem at hand, joins

  BackendThread(const BackendThread&) = delete;
  BackendThread& operator=(const BackendThread&) = delete;

 private:
  void run(const std::stop_token& stop);

  const char* name_;
  SpscRing<BackendJob>& asked_;
  SpscRing<BackendJob>& solved_;
  BackendOptions options_;
  JobCounters& counters_;
  std::jthread thread_;
};

}  // namespace povslam
