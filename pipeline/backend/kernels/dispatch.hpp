// Picks the kernels once, for the instruction set of pipeline/base/isa.hpp.
#pragma once

#include "pipeline/backend/kernels/kernels.hpp"
#include "pipeline/base/isa.hpp"

namespace povslam {

const VemKernels& vem_kernels();         // of chosen_isa()
const VemKernels& vem_kernels(int isa);  // at most widest_isa(): for tests and benchmarks

}  // namespace povslam
