// Which instruction set the vector kernels of this process run on: the widest of x86-64-v2, v3 (AVX2), v4 (AVX-512)
// that the CPU has. The environment variable POVSLAM_ISA=v2|v3|v4 lowers the choice, never raises it.
#pragma once

namespace povslam {

inline constexpr int kNumIsas = 3;  // v2, v3, v4

int widest_isa();  // of this CPU: 0 = v2, 1 = v3, 2 = v4
int chosen_isa();  // decided once

}  // namespace povslam
