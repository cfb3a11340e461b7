// Lanes of AVX2: 8 lanes. Only for lanes.hpp.
#pragma once

namespace povslam::POVSLAM_ISA {

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
POVSLAM_INLINE Floats load(const float* p) {
  return _mm256_loadu_ps(p);
}
POVSLAM_INLINE Ints load(const int32_t* p) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i_u*>(p));
}
POVSLAM_INLINE Ints load(const uint32_t* p) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i_u*>(p));
}
POVSLAM_INLINE void store(uint32_t* p, Ints a) {
  _mm256_storeu_si256(reinterpret_cast<__m256i_u*>(p), a);
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
POVSLAM_INLINE Mask equal(Ints a, Ints b) {
  return _mm256_castsi256_ps(_mm256_cmpeq_epi32(a, b));
}
POVSLAM_INLINE Mask within(Ints a, int size) {
  return _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_min_epu32(a, _mm256_set1_epi32(size - 1)), a));
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
POVSLAM_INLINE Mask neither(Mask a, Mask b) {
  return _mm256_xor_ps(_mm256_or_ps(a, b), _mm256_castsi256_ps(_mm256_set1_epi32(-1)));
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
POVSLAM_INLINE Ints gather(const uint32_t* base, Ints index, Mask mask) {
  return _mm256_mask_i32gather_epi32(_mm256_setzero_si256(), reinterpret_cast<const int*>(base), index,
                                     _mm256_castps_si256(mask), 4);
}
POVSLAM_INLINE Ints and_bits(Ints a, int mask) {
  return _mm256_and_si256(a, _mm256_set1_epi32(mask));
}
POVSLAM_INLINE Ints high_half(Ints a) {
  return _mm256_srli_epi32(a, 16);
}
POVSLAM_INLINE Floats to_floats(Ints a) {
  return _mm256_cvtepi32_ps(a);
}

POVSLAM_INLINE Ints shift_left(Ints a, int count) {
  return _mm256_sll_epi32(a, _mm_cvtsi32_si128(count));
}
POVSLAM_INLINE Ints shift_right(Ints a, int count) {
  return _mm256_srl_epi32(a, _mm_cvtsi32_si128(count));
}
POVSLAM_INLINE Ints or_bits(Ints a, Ints b) {
  return _mm256_or_si256(a, b);
}
POVSLAM_INLINE Ints select(Mask mask, Ints yes, Ints no) {
  return _mm256_blendv_epi8(no, yes, _mm256_castps_si256(mask));
}
// The inverse of bits().
POVSLAM_INLINE Mask lanes_of(unsigned bits) {
  const Ints one = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  return _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_and_si256(fill_int(static_cast<int>(bits)), one), one));
}
// 3 bytes a lane, the first in its lowest byte.
POVSLAM_INLINE Ints load_triples(const uint8_t* p) {
  return _mm256_inserti128_si256(_mm256_castsi128_si256(load_four_triples(p)), load_four_triples(p + 12), 1);
}
POVSLAM_INLINE void store_triples(uint8_t* p, Ints a) {
  store_four_triples(p, _mm256_castsi256_si128(a));
  store_four_triples(p + 12, _mm256_extracti128_si256(a, 1));
}

}  // namespace povslam::POVSLAM_ISA
