// `povslam simulate SCENE --out DIR`: drives the simulated robot and writes what it sees, with the truth, as a
// sequence.
#pragma once

#include <string>

#include "drivers/synthetic/options.hpp"

namespace povslam {

struct SimulateOptions {
  synthetic::SyntheticOptions world;
  std::string out;          // folder
  bool force = false;       // replace an earlier simulated sequence there
  bool truth_only = false;  // ground truth and calibration, no measurements: the truth of what the driver delivers live
};

// 0 success, 1 failure while writing, 2 bad options; says on standard error what was wrong.
int run_simulate(const SimulateOptions& options);

}  // namespace povslam
