// Picks the kernels once, for the instruction set of pipeline/base/isa.hpp.
#pragma once

#include "pipeline/frontend/kernels/kernels.hpp"

namespace povslam {

const FrontendKernels& frontend_kernels();

// Those this CPU can run, narrowest first; null after the last. For tests and benchmarks.
struct AvailableKernels {
  const FrontendKernels* kernels[4];
};
AvailableKernels available_kernels();

}  // namespace povslam
