// Picks the kernels once: the widest instruction set of x86-64-v2, v3 (AVX2), v4 (AVX-512) that the CPU has. The
// environment variable POVSLAM_ISA=v2|v3|v4 lowers the choice, never raises it.
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
