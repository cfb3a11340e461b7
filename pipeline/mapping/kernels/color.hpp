// Colours of voxels, four at a time on every machine: they lie interleaved. Only for *.kernel.cpp.
#pragma once

#include "pipeline/mapping/kernels/rays.hpp"

namespace povslam::POVSLAM_ISA {

// Bytes c, c + 3, c + 6, c + 9 as floats.
POVSLAM_INLINE __m128 channel_of(__m128i colors, char c) {
  const char none = -128;
  const auto at = [c](int k) { return static_cast<char>(3 * k + c); };
  const __m128i places =
      _mm_setr_epi8(at(0), none, none, none, at(1), none, none, none, at(2), none, none, none, at(3), none, none, none);
  return _mm_cvtepi32_ps(_mm_shuffle_epi8(colors, places));
}

// Red in the lowest byte, then green, blue.
POVSLAM_INLINE uint32_t read_pixel(const IntegratePass& pass, const uint8_t* pixel) {
  if (pass.channels == 1) return *pixel * 0x010101U;
  if (pixel > pass.color_last)
    return pixel[0] | static_cast<uint32_t>(pixel[1]) << 8 | static_cast<uint32_t>(pixel[2]) << 16;
  uint32_t four;
  __builtin_memcpy(&four, pixel, sizeof four);
  return four;
}

// A colour moves by at least an eighth, or old looks would hold it for ever. Black: none yet, taken over at once.
POVSLAM_INLINE void blend_colors(__m128i seen, __m128 share, __m128i lanes, uint8_t* color) {
  uint64_t low;
  uint32_t high;
  __builtin_memcpy(&low, color, sizeof low);
  __builtin_memcpy(&high, color + sizeof low, sizeof high);
  const __m128i have = _mm_set_epi64x(static_cast<int64_t>(high), static_cast<int64_t>(low));
  const __m128 r = channel_of(have, 0), g = channel_of(have, 1), b = channel_of(have, 2);
  const __m128 black = _mm_cmpeq_ps(_mm_add_ps(_mm_add_ps(r, g), b), _mm_setzero_ps());
  share = _mm_blendv_ps(_mm_max_ps(share, _mm_set1_ps(0.125F)), _mm_set1_ps(1.0F), black);
  const __m128i byte = _mm_set1_epi32(255);
  const auto mixed = [&](__m128 old, __m128i want) {
    const __m128 wanted = _mm_cvtepi32_ps(_mm_and_si128(want, byte));
    return _mm_cvtps_epi32(_mm_add_ps(old, _mm_mul_ps(_mm_sub_ps(wanted, old), share)));
  };
  const __m128i red = mixed(r, seen), green = mixed(g, _mm_srli_epi32(seen, 8)),
                blue = mixed(b, _mm_srli_epi32(seen, 16));
  __m128i out = _mm_or_si128(red, _mm_or_si128(_mm_slli_epi32(green, 8), _mm_slli_epi32(blue, 16)));
  const __m128i join = _mm_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -128, -128, -128, -128);
  out = _mm_blendv_epi8(have, _mm_shuffle_epi8(out, join), _mm_shuffle_epi8(lanes, join));
  const auto out_low = static_cast<uint64_t>(_mm_cvtsi128_si64(out));
  const auto out_high = static_cast<uint32_t>(_mm_extract_epi32(out, 2));
  __builtin_memcpy(color, &out_low, sizeof out_low);
  __builtin_memcpy(color + sizeof out_low, &out_high, sizeof out_high);
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
    const auto seen = [&](int k) {  // lanes that are not wanted may lie outside of the image
      if ((four >> k & 1U) == 0) return 0;
      return static_cast<int>(
          read_pixel(pass, pass.color + row[first + k] * pass.color_stride + column[first + k] * pass.channels));
    };
    const __m128i flags = _mm_and_si128(_mm_set1_epi32(static_cast<int>(four)), _mm_setr_epi32(1, 2, 4, 8));
    const __m128i lanes = _mm_cmpgt_epi32(flags, _mm_setzero_si128());
    blend_colors(_mm_setr_epi32(seen(0), seen(1), seen(2), seen(3)), _mm_load_ps(part + first), lanes,
                 color + 3 * first);
  }
}

}  // namespace povslam::POVSLAM_ISA
