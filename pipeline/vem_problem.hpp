// A window of variational EM as the pipeline asks it and gets it back: filled on the tracking thread, solved beside it.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/backend/vem.hpp"

namespace povslam {

struct VemProblem {
  VemWindow window;
  std::vector<std::int64_t> object;  // id of each of the window's; -1: structure and what is nobody's
  BeliefOptions belief;              // as the object library has them
  std::int64_t asked_at_frame = 0;
  VemResult result;  // answer
};

}  // namespace povslam
