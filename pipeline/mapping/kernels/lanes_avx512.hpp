// Lanes of AVX-512: 16 lanes. Only for lanes.hpp.
#pragma once

namespace povslam::POVSLAM_ISA {

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
POVSLAM_INLINE Floats load(const float* p) {
  return _mm512_loadu_ps(p);
}
POVSLAM_INLINE Ints load(const int32_t* p) {
  return _mm512_loadu_si512(p);
}
POVSLAM_INLINE Ints load(const uint32_t* p) {
  return _mm512_loadu_si512(p);
}
POVSLAM_INLINE void store(uint32_t* p, Ints a) {
  _mm512_storeu_si512(p, a);
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
// 0 <= a < size
POVSLAM_INLINE Mask equal(Ints a, Ints b) {
  return _mm512_cmpeq_epi32_mask(a, b);
}
POVSLAM_INLINE Mask within(Ints a, int size) {
  return _mm512_cmplt_epu32_mask(a, _mm512_set1_epi32(size));
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
POVSLAM_INLINE Mask neither(Mask a, Mask b) {
  return static_cast<Mask>(~(a | b));
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
POVSLAM_INLINE Ints gather(const uint32_t* base, Ints index, Mask mask) {
  return _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), mask, index, base, 4);
}
POVSLAM_INLINE Ints and_bits(Ints a, int mask) {
  return _mm512_and_si512(a, _mm512_set1_epi32(mask));
}
POVSLAM_INLINE Ints high_half(Ints a) {
  return _mm512_srli_epi32(a, 16);
}
POVSLAM_INLINE Floats to_floats(Ints a) {
  return _mm512_cvtepi32_ps(a);
}

POVSLAM_INLINE Ints shift_left(Ints a, int count) {
  return _mm512_sll_epi32(a, _mm_cvtsi32_si128(count));
}
POVSLAM_INLINE Ints shift_right(Ints a, int count) {
  return _mm512_srl_epi32(a, _mm_cvtsi32_si128(count));
}
POVSLAM_INLINE Ints or_bits(Ints a, Ints b) {
  return _mm512_or_si512(a, b);
}
POVSLAM_INLINE Ints select(Mask mask, Ints yes, Ints no) {
  return _mm512_mask_blend_epi32(mask, no, yes);
}
// The inverse of bits().
POVSLAM_INLINE Mask lanes_of(unsigned bits) {
  return static_cast<Mask>(bits);
}
// 3 bytes a lane, the first in its lowest byte.
POVSLAM_INLINE Ints load_triples(const uint8_t* p) {
  Ints four = _mm512_castsi128_si512(load_four_triples(p));
  four = _mm512_inserti32x4(four, load_four_triples(p + 12), 1);
  four = _mm512_inserti32x4(four, load_four_triples(p + 24), 2);
  return _mm512_inserti32x4(four, load_four_triples(p + 36), 3);
}
POVSLAM_INLINE void store_triples(uint8_t* p, Ints a) {
  store_four_triples(p, _mm512_castsi512_si128(a));
  store_four_triples(p + 12, _mm512_extracti32x4_epi32(a, 1));
  store_four_triples(p + 24, _mm512_extracti32x4_epi32(a, 2));
  store_four_triples(p + 36, _mm512_extracti32x4_epi32(a, 3));
}

}  // namespace povslam::POVSLAM_ISA
