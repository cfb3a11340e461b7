// The widest byte vector of the instruction set a kernel is compiled for. Only for *.kernel.cpp.
#pragma once

#include <immintrin.h>
#include <stdint.h>

#define POVSLAM_INLINE static inline __attribute__((always_inline, unused))

namespace povslam::POVSLAM_ISA {

#if defined(__AVX512BW__)
using Bytes = __m512i;
enum { kLanes = 64 };
POVSLAM_INLINE Bytes load(const uint8_t* p) {
  return _mm512_loadu_si512(p);
}
POVSLAM_INLINE void store(uint8_t* p, Bytes a) {
  _mm512_storeu_si512(p, a);
}
POVSLAM_INLINE Bytes fill8(int value) {
  return _mm512_set1_epi8(static_cast<char>(value));
}
POVSLAM_INLINE Bytes fill16(int value) {
  return _mm512_set1_epi16(static_cast<short>(value));
}
POVSLAM_INLINE Bytes zero() {
  return _mm512_setzero_si512();
}
POVSLAM_INLINE Bytes min(Bytes a, Bytes b) {
  return _mm512_min_epu8(a, b);
}
POVSLAM_INLINE Bytes max(Bytes a, Bytes b) {
  return _mm512_max_epu8(a, b);
}
POVSLAM_INLINE Bytes subs(Bytes a, Bytes b) {
  return _mm512_subs_epu8(a, b);
}
POVSLAM_INLINE Bytes adds(Bytes a, Bytes b) {
  return _mm512_adds_epu8(a, b);
}
POVSLAM_INLINE uint64_t greater(Bytes a, Bytes b) {
  return _mm512_cmpgt_epu8_mask(a, b);
}
POVSLAM_INLINE Bytes keep_greater(Bytes a, Bytes b) {
  return _mm512_maskz_mov_epi8(_mm512_cmpgt_epu8_mask(a, b), a);
}
POVSLAM_INLINE Bytes unpack_low(Bytes a, Bytes b) {
  return _mm512_unpacklo_epi8(a, b);
}
POVSLAM_INLINE Bytes unpack_high(Bytes a, Bytes b) {
  return _mm512_unpackhi_epi8(a, b);
}
POVSLAM_INLINE Bytes multiply_pairs(Bytes a, Bytes weights) {
  return _mm512_maddubs_epi16(a, weights);
}
POVSLAM_INLINE Bytes add16(Bytes a, Bytes b) {
  return _mm512_add_epi16(a, b);
}
POVSLAM_INLINE Bytes sub16(Bytes a, Bytes b) {
  return _mm512_sub_epi16(a, b);
}
POVSLAM_INLINE Bytes multiply_round16(Bytes a, Bytes b) {
  return _mm512_mulhrs_epi16(a, b);
}
template <int kShift>
POVSLAM_INLINE Bytes shift_right16(Bytes a) {
  return _mm512_srli_epi16(a, kShift);
}
POVSLAM_INLINE Bytes pack(Bytes low, Bytes high) {
  return _mm512_packus_epi16(low, high);
}
#elif defined(__AVX2__)
using Bytes = __m256i;
enum { kLanes = 32 };
POVSLAM_INLINE Bytes load(const uint8_t* p) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i_u*>(p));
}
POVSLAM_INLINE void store(uint8_t* p, Bytes a) {
  _mm256_storeu_si256(reinterpret_cast<__m256i_u*>(p), a);
}
POVSLAM_INLINE Bytes fill8(int value) {
  return _mm256_set1_epi8(static_cast<char>(value));
}
POVSLAM_INLINE Bytes fill16(int value) {
  return _mm256_set1_epi16(static_cast<short>(value));
}
POVSLAM_INLINE Bytes zero() {
  return _mm256_setzero_si256();
}
POVSLAM_INLINE Bytes min(Bytes a, Bytes b) {
  return _mm256_min_epu8(a, b);
}
POVSLAM_INLINE Bytes max(Bytes a, Bytes b) {
  return _mm256_max_epu8(a, b);
}
POVSLAM_INLINE Bytes subs(Bytes a, Bytes b) {
  return _mm256_subs_epu8(a, b);
}
POVSLAM_INLINE Bytes adds(Bytes a, Bytes b) {
  return _mm256_adds_epu8(a, b);
}
POVSLAM_INLINE uint64_t greater(Bytes a, Bytes b) {
  return ~static_cast<uint32_t>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(subs(a, b), zero())));
}
POVSLAM_INLINE Bytes keep_greater(Bytes a, Bytes b) {
  return _mm256_andnot_si256(_mm256_cmpeq_epi8(subs(a, b), zero()), a);
}
POVSLAM_INLINE Bytes unpack_low(Bytes a, Bytes b) {
  return _mm256_unpacklo_epi8(a, b);
}
POVSLAM_INLINE Bytes unpack_high(Bytes a, Bytes b) {
  return _mm256_unpackhi_epi8(a, b);
}
POVSLAM_INLINE Bytes multiply_pairs(Bytes a, Bytes weights) {
  return _mm256_maddubs_epi16(a, weights);
}
POVSLAM_INLINE Bytes add16(Bytes a, Bytes b) {
  return _mm256_add_epi16(a, b);
}
POVSLAM_INLINE Bytes sub16(Bytes a, Bytes b) {
  return _mm256_sub_epi16(a, b);
}
POVSLAM_INLINE Bytes multiply_round16(Bytes a, Bytes b) {
  return _mm256_mulhrs_epi16(a, b);
}
template <int kShift>
POVSLAM_INLINE Bytes shift_right16(Bytes a) {
  return _mm256_srli_epi16(a, kShift);
}
POVSLAM_INLINE Bytes pack(Bytes low, Bytes high) {
  return _mm256_packus_epi16(low, high);
}
#else
using Bytes = __m128i;
enum { kLanes = 16 };
POVSLAM_INLINE Bytes load(const uint8_t* p) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i_u*>(p));
}
POVSLAM_INLINE void store(uint8_t* p, Bytes a) {
  _mm_storeu_si128(reinterpret_cast<__m128i_u*>(p), a);
}
POVSLAM_INLINE Bytes fill8(int value) {
  return _mm_set1_epi8(static_cast<char>(value));
}
POVSLAM_INLINE Bytes fill16(int value) {
  return _mm_set1_epi16(static_cast<short>(value));
}
POVSLAM_INLINE Bytes zero() {
  return _mm_setzero_si128();
}
POVSLAM_INLINE Bytes min(Bytes a, Bytes b) {
  return _mm_min_epu8(a, b);
}
POVSLAM_INLINE Bytes max(Bytes a, Bytes b) {
  return _mm_max_epu8(a, b);
}
POVSLAM_INLINE Bytes subs(Bytes a, Bytes b) {
  return _mm_subs_epu8(a, b);
}
POVSLAM_INLINE Bytes adds(Bytes a, Bytes b) {
  return _mm_adds_epu8(a, b);
}
POVSLAM_INLINE uint64_t greater(Bytes a, Bytes b) {
  return ~static_cast<uint32_t>(_mm_movemask_epi8(_mm_cmpeq_epi8(subs(a, b), zero()))) & 0xFFFFU;
}
POVSLAM_INLINE Bytes keep_greater(Bytes a, Bytes b) {
  return _mm_andnot_si128(_mm_cmpeq_epi8(subs(a, b), zero()), a);
}
POVSLAM_INLINE Bytes unpack_low(Bytes a, Bytes b) {
  return _mm_unpacklo_epi8(a, b);
}
POVSLAM_INLINE Bytes unpack_high(Bytes a, Bytes b) {
  return _mm_unpackhi_epi8(a, b);
}
POVSLAM_INLINE Bytes multiply_pairs(Bytes a, Bytes weights) {
  return _mm_maddubs_epi16(a, weights);
}
POVSLAM_INLINE Bytes add16(Bytes a, Bytes b) {
  return _mm_add_epi16(a, b);
}
POVSLAM_INLINE Bytes sub16(Bytes a, Bytes b) {
  return _mm_sub_epi16(a, b);
}
POVSLAM_INLINE Bytes multiply_round16(Bytes a, Bytes b) {
  return _mm_mulhrs_epi16(a, b);
}
template <int kShift>
POVSLAM_INLINE Bytes shift_right16(Bytes a) {
  return _mm_srli_epi16(a, kShift);
}
POVSLAM_INLINE Bytes pack(Bytes low, Bytes high) {
  return _mm_packus_epi16(low, high);
}
#endif

POVSLAM_INLINE Bytes load16(const uint16_t* p) {
  return load(reinterpret_cast<const uint8_t*>(p));
}

}  // namespace povslam::POVSLAM_ISA
