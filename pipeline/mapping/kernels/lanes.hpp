// Single-precision lanes of the instruction set a kernel is compiled for. Only for *.kernel.cpp.
// a + b, a * b and so on are the compiler's own. Masks say which lanes; gather() reads nothing where they are not set.
#pragma once

// GCC 12 takes the "any value" operands in its own header for mistakes.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <immintrin.h>
#pragma GCC diagnostic pop
#include <stdint.h>

#define POVSLAM_INLINE static inline __attribute__((always_inline, unused))

#include "pipeline/mapping/kernels/triples.hpp"

#if defined(__AVX512BW__)
#include "pipeline/mapping/kernels/lanes_avx512.hpp"
#elif defined(__AVX2__)
#include "pipeline/mapping/kernels/lanes_avx2.hpp"
#else
#include "pipeline/mapping/kernels/lanes_sse.hpp"
#endif
