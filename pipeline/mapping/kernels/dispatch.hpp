// Picks the kernels once, for the instruction set of pipeline/base/isa.hpp.
#pragma once

#include "pipeline/base/isa.hpp"
#include "pipeline/mapping/kernels/kernels.hpp"

namespace povslam {

const MappingKernels& mapping_kernels();         // of chosen_isa()
const MappingKernels& mapping_kernels(int isa);  // at most widest_isa(): for tests and benchmarks

}  // namespace povslam
