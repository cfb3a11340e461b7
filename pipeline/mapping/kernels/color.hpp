// Colours of voxels, four at a time on every machine: they lie interleaved. Only for *.kernel.cpp.
#pragma once

#include "pipeline/mapping/kernels/rays.hpp"

namespace povslam::POVSLAM_ISA {

// Bytes c, c + 3, c + 6, c + 9 as floats.
POVSLAM_INLINE __m128 channel_of(__m128i colors, int c) {
  const __m128i places =
      _mm_add_epi8(_mm_setr_epi8(0, -128, -128, -128, 3, -128, -128, -128, 6, -128, -128, -128, 9, -128, -128, -128),
                   _mm_set1_epi8(static_cast<char>(c)));
  return _mm_cvtepi32_ps(_mm_shuffle_epi8(colors, places));
}

// The pixels of four voxels as 12 bytes.
struct SeenColors {
  alignas(16) uint8_t bytes[16];
};

// A colour moves by at least an eighth, or old looks would hold it for ever. Black: none yet, taken over at once.
POVSLAM_INLINE void blend_colors(const SeenColors& seen, __m128 share, __m128i lanes, uint8_t* color) {
  uint64_t low;
  uint32_t high;
  __builtin_memcpy(&low, color, 8);
  __builtin_memcpy(&high, color + 8, 4);
  const __m128i have = _mm_set_epi64x(static_cast<int64_t>(high), static_cast<int64_t>(low));
  const __m128i want = _mm_load_si128(reinterpret_cast<const __m128i*>(seen.bytes));
  const __m128 r = channel_of(have, 0), g = channel_of(have, 1), b = channel_of(have, 2);
  const __m128 black = _mm_cmpeq_ps(_mm_add_ps(_mm_add_ps(r, g), b), _mm_setzero_ps());
  share = _mm_blendv_ps(_mm_max_ps(share, _mm_set1_ps(0.125F)), _mm_set1_ps(1.0F), black);
  const auto mixed = [&](__m128 old, int c) {
    return _mm_cvtps_epi32(_mm_add_ps(old, _mm_mul_ps(_mm_sub_ps(channel_of(want, c), old), share)));
  };
  __m128i out =
      _mm_or_si128(_mm_or_si128(mixed(r, 0), _mm_slli_epi32(mixed(g, 1), 8)), _mm_slli_epi32(mixed(b, 2), 16));
  const __m128i join = _mm_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -128, -128, -128, -128);
  out = _mm_blendv_epi8(have, _mm_shuffle_epi8(out, join), _mm_shuffle_epi8(lanes, join));
  const auto out_low = static_cast<uint64_t>(_mm_cvtsi128_si64(out));
  const auto out_high = static_cast<uint32_t>(_mm_extract_epi32(out, 2));
  __builtin_memcpy(color, &out_low, 8);
  __builtin_memcpy(color + 8, &out_high, 4);
}

// Of the lanes in `mask`; share: how much the new look counts. color: of the first lane's voxel.
POVSLAM_INLINE void color_voxels(const IntegratePass& pass, const Rays& rays, Mask mask, Floats share, uint8_t* color) {
  alignas(64) int32_t row[kLanes], column[kLanes];
  alignas(64) float part[kLanes];
  store(row, rays.row);
  store(column, rays.column);
  store(part, share);
  const unsigned wanted = bits(mask);
  for (int first = 0; first < kLanes; first += 4) {
    const unsigned four = wanted >> first & 15U;
    if (four == 0) continue;
    SeenColors seen{};
    for (unsigned left = four; left != 0; left &= left - 1) {
      const int lane = __builtin_ctz(left);
      const uint8_t* pixel = pass.color + row[first + lane] * pass.color_stride + column[first + lane] * pass.channels;
      for (int c = 0; c < 3; ++c) seen.bytes[3 * lane + c] = pixel[pass.channels == 3 ? c : 0];
    }
    const __m128i flags = _mm_and_si128(_mm_set1_epi32(static_cast<int>(four)), _mm_setr_epi32(1, 2, 4, 8));
    const __m128i lanes = _mm_cmpgt_epi32(flags, _mm_setzero_si128());
    blend_colors(seen, _mm_load_ps(part + first), lanes, color + 3 * first);
  }
}

}  // namespace povslam::POVSLAM_ISA
