// Lanes of SSE4.2: 4 lanes. Only for lanes.hpp.
#pragma once

namespace povslam::POVSLAM_ISA {

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
POVSLAM_INLINE Floats load(const float* p) {
  return _mm_loadu_ps(p);
}
POVSLAM_INLINE Ints load(const int32_t* p) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i_u*>(p));
}
POVSLAM_INLINE Ints load(const uint32_t* p) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i_u*>(p));
}
POVSLAM_INLINE void store(uint32_t* p, Ints a) {
  _mm_storeu_si128(reinterpret_cast<__m128i_u*>(p), a);
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
POVSLAM_INLINE Mask equal(Ints a, Ints b) {
  return _mm_castsi128_ps(_mm_cmpeq_epi32(a, b));
}
POVSLAM_INLINE Mask within(Ints a, int size) {
  return _mm_castsi128_ps(_mm_cmpeq_epi32(_mm_min_epu32(a, _mm_set1_epi32(size - 1)), a));
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
POVSLAM_INLINE Mask neither(Mask a, Mask b) {
  return _mm_xor_ps(_mm_or_ps(a, b), _mm_castsi128_ps(_mm_set1_epi32(-1)));
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
POVSLAM_INLINE Ints gather(const uint32_t* base, Ints index, Mask mask) {
  alignas(16) int32_t at[4];
  alignas(16) uint32_t value[4] = {0, 0, 0, 0};
  store(at, index);
  for (unsigned left = bits(mask); left != 0; left &= left - 1) {
    const int lane = __builtin_ctz(left);
    value[lane] = base[at[lane]];
  }
  return _mm_load_si128(reinterpret_cast<const __m128i*>(value));
}
POVSLAM_INLINE Ints and_bits(Ints a, int mask) {
  return _mm_and_si128(a, _mm_set1_epi32(mask));
}
POVSLAM_INLINE Ints high_half(Ints a) {
  return _mm_srli_epi32(a, 16);
}
POVSLAM_INLINE Floats to_floats(Ints a) {
  return _mm_cvtepi32_ps(a);
}

POVSLAM_INLINE Ints shift_left(Ints a, int count) {
  return _mm_sll_epi32(a, _mm_cvtsi32_si128(count));
}
POVSLAM_INLINE Ints shift_right(Ints a, int count) {
  return _mm_srl_epi32(a, _mm_cvtsi32_si128(count));
}
POVSLAM_INLINE Ints or_bits(Ints a, Ints b) {
  return _mm_or_si128(a, b);
}
POVSLAM_INLINE Ints select(Mask mask, Ints yes, Ints no) {
  return _mm_blendv_epi8(no, yes, _mm_castps_si128(mask));
}
// The inverse of bits().
POVSLAM_INLINE Mask lanes_of(unsigned bits) {
  const Ints one = _mm_setr_epi32(1, 2, 4, 8);
  return _mm_castsi128_ps(_mm_cmpeq_epi32(_mm_and_si128(fill_int(static_cast<int>(bits)), one), one));
}
// 3 bytes a lane, the first in its lowest byte.
POVSLAM_INLINE Ints load_triples(const uint8_t* p) {
  return load_four_triples(p);
}
POVSLAM_INLINE void store_triples(uint8_t* p, Ints a) {
  store_four_triples(p, a);
}

}  // namespace povslam::POVSLAM_ISA
