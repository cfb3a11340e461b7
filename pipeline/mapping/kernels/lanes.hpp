// Single-precision lanes of the instruction set a kernel is compiled for. Only for *.kernel.cpp.
// a + b, a * b and so on are the compiler's own.
#pragma once

// GCC 12 takes the "any value" operands in its own header for mistakes.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include <immintrin.h>
#pragma GCC diagnostic pop
#include <stdint.h>

#define POVSLAM_INLINE static inline __attribute__((always_inline, unused))

namespace povslam::POVSLAM_ISA {

#if defined(__AVX512BW__)
enum { kLanes = 16 };
using Floats = __m512;
using Ints = __m512i;
using Mask = __mmask16;
POVSLAM_INLINE Floats fill(float a) {
  return _mm512_set1_ps(a);
}
POVSLAM_INLINE Ints fill_int(int a) {
  return _mm512_set1_epi32(a);
}
// Eight lanes of each.
POVSLAM_INLINE Floats fill_rows(float first, float second) {
  return _mm512_mask_blend_ps(0xFF00, _mm512_set1_ps(first), _mm512_set1_ps(second));
}
POVSLAM_INLINE Floats load(const float* p) {
  return _mm512_loadu_ps(p);
}
POVSLAM_INLINE void store(int32_t* p, Ints a) {
  _mm512_storeu_si512(p, a);
}
POVSLAM_INLINE void store(float* p, Floats a) {
  _mm512_storeu_ps(p, a);
}
POVSLAM_INLINE Floats load16(const int16_t* p) {
  return _mm512_cvtepi32_ps(_mm512_cvtepi16_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i_u*>(p))));
}
POVSLAM_INLINE Floats load16(const uint16_t* p) {
  return _mm512_cvtepi32_ps(_mm512_cvtepu16_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i_u*>(p))));
}
POVSLAM_INLINE void store16(int16_t* p, Floats a) {
  _mm256_storeu_si256(reinterpret_cast<__m256i_u*>(p), _mm512_cvtepi32_epi16(_mm512_cvtps_epi32(a)));
}
POVSLAM_INLINE void store16(uint16_t* p, Floats a) {
  _mm256_storeu_si256(reinterpret_cast<__m256i_u*>(p), _mm512_cvtepi32_epi16(_mm512_cvtps_epi32(a)));
}
POVSLAM_INLINE Ints round_to_int(Floats a) {
  return _mm512_cvtps_epi32(a);
}
POVSLAM_INLINE Floats round_down(Floats a) {
  return _mm512_floor_ps(a);
}
POVSLAM_INLINE Floats nearest(Floats a) {
  return _mm512_roundscale_ps(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}
POVSLAM_INLINE Ints add(Ints a, Ints b) {
  return _mm512_add_epi32(a, b);
}
POVSLAM_INLINE Ints multiply(Ints a, Ints b) {
  return _mm512_mullo_epi32(a, b);
}
POVSLAM_INLINE Floats lesser(Floats a, Floats b) {
  return _mm512_min_ps(a, b);
}
POVSLAM_INLINE Floats greater(Floats a, Floats b) {
  return _mm512_max_ps(a, b);
}
POVSLAM_INLINE Floats magnitude(Floats a) {
  return _mm512_abs_ps(a);
}
POVSLAM_INLINE Mask above(Floats a, Floats b) {
  return _mm512_cmp_ps_mask(a, b, _CMP_GT_OQ);
}
POVSLAM_INLINE Mask at_least(Floats a, Floats b) {
  return _mm512_cmp_ps_mask(a, b, _CMP_GE_OQ);
}
POVSLAM_INLINE Mask above(Ints a, Ints b) {
  return _mm512_cmpgt_epi32_mask(a, b);
}
POVSLAM_INLINE Mask both(Mask a, Mask b) {
  return static_cast<Mask>(a & b);
}
POVSLAM_INLINE Mask either(Mask a, Mask b) {
  return static_cast<Mask>(a | b);
}
POVSLAM_INLINE Mask but_not(Mask a, Mask b) {
  return static_cast<Mask>(a & ~b);
}
POVSLAM_INLINE Floats select(Mask mask, Floats yes, Floats no) {
  return _mm512_mask_blend_ps(mask, no, yes);
}
POVSLAM_INLINE unsigned bits(Mask mask) {
  return mask;
}
// 0 where the mask is not set; nothing is read there.
POVSLAM_INLINE Floats gather(const float* base, Ints index, Mask mask) {
  return _mm512_mask_i32gather_ps(_mm512_setzero_ps(), mask, index, base, 4);
}
#elif defined(__AVX2__)
enum { kLanes = 8 };
using Floats = __m256;
using Ints = __m256i;
using Mask = __m256;
POVSLAM_INLINE Floats fill(float a) {
  return _mm256_set1_ps(a);
}
POVSLAM_INLINE Ints fill_int(int a) {
  return _mm256_set1_epi32(a);
}
POVSLAM_INLINE Floats fill_rows(float first, float) {
  return fill(first);
}
POVSLAM_INLINE Floats load(const float* p) {
  return _mm256_loadu_ps(p);
}
POVSLAM_INLINE void store(int32_t* p, Ints a) {
  _mm256_storeu_si256(reinterpret_cast<__m256i_u*>(p), a);
}
POVSLAM_INLINE void store(float* p, Floats a) {
  _mm256_storeu_ps(p, a);
}
POVSLAM_INLINE Floats load16(const int16_t* p) {
  return _mm256_cvtepi32_ps(_mm256_cvtepi16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i_u*>(p))));
}
POVSLAM_INLINE Floats load16(const uint16_t* p) {
  return _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i_u*>(p))));
}
POVSLAM_INLINE void store16(int16_t* p, Floats a) {
  const Ints i = _mm256_cvtps_epi32(a);
  _mm_storeu_si128(reinterpret_cast<__m128i_u*>(p),
                   _mm_packs_epi32(_mm256_castsi256_si128(i), _mm256_extracti128_si256(i, 1)));
}
POVSLAM_INLINE void store16(uint16_t* p, Floats a) {
  const Ints i = _mm256_cvtps_epi32(a);
  _mm_storeu_si128(reinterpret_cast<__m128i_u*>(p),
                   _mm_packus_epi32(_mm256_castsi256_si128(i), _mm256_extracti128_si256(i, 1)));
}
POVSLAM_INLINE Ints round_to_int(Floats a) {
  return _mm256_cvtps_epi32(a);
}
POVSLAM_INLINE Floats round_down(Floats a) {
  return _mm256_floor_ps(a);
}
POVSLAM_INLINE Floats nearest(Floats a) {
  return _mm256_round_ps(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}
POVSLAM_INLINE Ints add(Ints a, Ints b) {
  return _mm256_add_epi32(a, b);
}
POVSLAM_INLINE Ints multiply(Ints a, Ints b) {
  return _mm256_mullo_epi32(a, b);
}
POVSLAM_INLINE Floats lesser(Floats a, Floats b) {
  return _mm256_min_ps(a, b);
}
POVSLAM_INLINE Floats greater(Floats a, Floats b) {
  return _mm256_max_ps(a, b);
}
POVSLAM_INLINE Floats magnitude(Floats a) {
  return _mm256_andnot_ps(_mm256_set1_ps(-0.0F), a);
}
POVSLAM_INLINE Mask above(Floats a, Floats b) {
  return _mm256_cmp_ps(a, b, _CMP_GT_OQ);
}
POVSLAM_INLINE Mask at_least(Floats a, Floats b) {
  return _mm256_cmp_ps(a, b, _CMP_GE_OQ);
}
POVSLAM_INLINE Mask above(Ints a, Ints b) {
  return _mm256_castsi256_ps(_mm256_cmpgt_epi32(a, b));
}
POVSLAM_INLINE Mask both(Mask a, Mask b) {
  return _mm256_and_ps(a, b);
}
POVSLAM_INLINE Mask either(Mask a, Mask b) {
  return _mm256_or_ps(a, b);
}
POVSLAM_INLINE Mask but_not(Mask a, Mask b) {
  return _mm256_andnot_ps(b, a);
}
POVSLAM_INLINE Floats select(Mask mask, Floats yes, Floats no) {
  return _mm256_blendv_ps(no, yes, mask);
}
POVSLAM_INLINE unsigned bits(Mask mask) {
  return static_cast<unsigned>(_mm256_movemask_ps(mask));
}
POVSLAM_INLINE Floats gather(const float* base, Ints index, Mask mask) {
  return _mm256_mask_i32gather_ps(_mm256_setzero_ps(), base, index, mask, 4);
}
#else
enum { kLanes = 4 };
using Floats = __m128;
using Ints = __m128i;
using Mask = __m128;
POVSLAM_INLINE Floats fill(float a) {
  return _mm_set1_ps(a);
}
POVSLAM_INLINE Ints fill_int(int a) {
  return _mm_set1_epi32(a);
}
POVSLAM_INLINE Floats fill_rows(float first, float) {
  return fill(first);
}
POVSLAM_INLINE Floats load(const float* p) {
  return _mm_loadu_ps(p);
}
POVSLAM_INLINE void store(int32_t* p, Ints a) {
  _mm_storeu_si128(reinterpret_cast<__m128i_u*>(p), a);
}
POVSLAM_INLINE void store(float* p, Floats a) {
  _mm_storeu_ps(p, a);
}
POVSLAM_INLINE Floats load16(const int16_t* p) {
  return _mm_cvtepi32_ps(_mm_cvtepi16_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i_u*>(p))));
}
POVSLAM_INLINE Floats load16(const uint16_t* p) {
  return _mm_cvtepi32_ps(_mm_cvtepu16_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i_u*>(p))));
}
POVSLAM_INLINE void store16(int16_t* p, Floats a) {
  const Ints i = _mm_cvtps_epi32(a);
  _mm_storel_epi64(reinterpret_cast<__m128i_u*>(p), _mm_packs_epi32(i, i));
}
POVSLAM_INLINE void store16(uint16_t* p, Floats a) {
  const Ints i = _mm_cvtps_epi32(a);
  _mm_storel_epi64(reinterpret_cast<__m128i_u*>(p), _mm_packus_epi32(i, i));
}
POVSLAM_INLINE Ints round_to_int(Floats a) {
  return _mm_cvtps_epi32(a);
}
POVSLAM_INLINE Floats round_down(Floats a) {
  return _mm_floor_ps(a);
}
POVSLAM_INLINE Floats nearest(Floats a) {
  return _mm_round_ps(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}
POVSLAM_INLINE Ints add(Ints a, Ints b) {
  return _mm_add_epi32(a, b);
}
POVSLAM_INLINE Ints multiply(Ints a, Ints b) {
  return _mm_mullo_epi32(a, b);
}
POVSLAM_INLINE Floats lesser(Floats a, Floats b) {
  return _mm_min_ps(a, b);
}
POVSLAM_INLINE Floats greater(Floats a, Floats b) {
  return _mm_max_ps(a, b);
}
POVSLAM_INLINE Floats magnitude(Floats a) {
  return _mm_andnot_ps(_mm_set1_ps(-0.0F), a);
}
POVSLAM_INLINE Mask above(Floats a, Floats b) {
  return _mm_cmpgt_ps(a, b);
}
POVSLAM_INLINE Mask at_least(Floats a, Floats b) {
  return _mm_cmpge_ps(a, b);
}
POVSLAM_INLINE Mask above(Ints a, Ints b) {
  return _mm_castsi128_ps(_mm_cmpgt_epi32(a, b));
}
POVSLAM_INLINE Mask both(Mask a, Mask b) {
  return _mm_and_ps(a, b);
}
POVSLAM_INLINE Mask either(Mask a, Mask b) {
  return _mm_or_ps(a, b);
}
POVSLAM_INLINE Mask but_not(Mask a, Mask b) {
  return _mm_andnot_ps(b, a);
}
POVSLAM_INLINE Floats select(Mask mask, Floats yes, Floats no) {
  return _mm_blendv_ps(no, yes, mask);
}
POVSLAM_INLINE unsigned bits(Mask mask) {
  return static_cast<unsigned>(_mm_movemask_ps(mask));
}
POVSLAM_INLINE Floats gather(const float* base, Ints index, Mask mask) {
  alignas(16) int32_t at[4];
  alignas(16) float value[4] = {0.0F, 0.0F, 0.0F, 0.0F};
  store(at, index);
  for (unsigned left = bits(mask); left != 0; left &= left - 1) {
    const int lane = __builtin_ctz(left);
    value[lane] = base[at[lane]];
  }
  return load(value);
}
#endif

}  // namespace povslam::POVSLAM_ISA
