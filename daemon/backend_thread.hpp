// The backend thread: solves what the pipeline asks beside tracking.
#pragma once

#include <thread>

#include "daemon/counters.hpp"
#include "pipeline/backend_job.hpp"
#include "pipeline/base/spsc_ring.hpp"

namespace povslam {

class BackendThread {
 public:
  BackendThread(SpscRing<BackendJob>& asked, SpscRing<BackendJob>& solved, const BackendOptions& options,
                Counters& counters);
  ~BackendThread();  // closes `asked`, finishes the problem at hand, joins

  BackendThread(const BackendThread&) = delete;
  BackendThread& operator=(const BackendThread&) = delete;

 private:
  void run(const std::stop_token& stop);

  SpscRing<BackendJob>& asked_;
  SpscRing<BackendJob>& solved_;
  BackendOptions options_;
  Counters& counters_;
  std::jthread thread_;
};

}  // namespace povslam
