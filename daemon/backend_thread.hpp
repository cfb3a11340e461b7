// The backend thread: solves the pipeline's bundle adjustments beside tracking.
#pragma once

#include <thread>

#include "daemon/counters.hpp"
#include "pipeline/backend/smooth.hpp"
#include "pipeline/base/spsc_ring.hpp"

namespace povslam {

class BackendThread {
 public:
  BackendThread(SpscRing<SmoothProblem*>& asked, SpscRing<SmoothProblem*>& solved, const SmoothOptions& options,
                Counters& counters);
  ~BackendThread();  // closes `asked`, finishes the problem at hand, joins

  BackendThread(const BackendThread&) = delete;
  BackendThread& operator=(const BackendThread&) = delete;

 private:
  void run(const std::stop_token& stop);

  SpscRing<SmoothProblem*>& asked_;
  SpscRing<SmoothProblem*>& solved_;
  SmoothOptions options_;
  Counters& counters_;
  std::jthread thread_;
};

}  // namespace povslam
