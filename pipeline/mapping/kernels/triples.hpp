// Four interleaved colours as four integers and back: the step all instruction sets have in common. Only for lanes.hpp.
#pragma once

namespace povslam::POVSLAM_ISA {

POVSLAM_INLINE __m128i load_four_triples(const uint8_t* p) {
  uint64_t low;
  uint32_t high;
  __builtin_memcpy(&low, p, sizeof low);
  __builtin_memcpy(&high, p + sizeof low, sizeof high);
  const __m128i packed = _mm_set_epi64x(static_cast<int64_t>(high), static_cast<int64_t>(low));
  const __m128i apart = _mm_setr_epi8(0, 1, 2, -128, 3, 4, 5, -128, 6, 7, 8, -128, 9, 10, 11, -128);
  return _mm_shuffle_epi8(packed, apart);
}

POVSLAM_INLINE void store_four_triples(uint8_t* p, __m128i a) {
  const __m128i join = _mm_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -128, -128, -128, -128);
  const __m128i packed = _mm_shuffle_epi8(a, join);
  const auto low = static_cast<uint64_t>(_mm_cvtsi128_si64(packed));
  const auto high = static_cast<uint32_t>(_mm_extract_epi32(packed, 2));
  __builtin_memcpy(p, &low, sizeof low);
  __builtin_memcpy(p + sizeof low, &high, sizeof high);
}

}  // namespace povslam::POVSLAM_ISA
