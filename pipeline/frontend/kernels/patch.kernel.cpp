// What is computed once per feature: the intensity centroid's moments and the rotated BRIEF bits
// (Rublee et al., ICCV 2011, sections 3.2 and 4).
#include "pipeline/frontend/kernels/kernels.hpp"
#include "pipeline/frontend/kernels/simd.hpp"

namespace povslam::POVSLAM_ISA {
namespace {

// 32 pixels of a row: their masked sum (in 64-bit lanes) and their weighted sum (in 16-bit lanes).
#if defined(__AVX2__)
using Row = __m256i;
POVSLAM_INLINE Row row_zero() {
  return _mm256_setzero_si256();
}
POVSLAM_INLINE Row row_load(const void* p) {
  return _mm256_loadu_si256(static_cast<const __m256i_u*>(p));
}
POVSLAM_INLINE Row row_sum(Row p, Row inside) {
  return _mm256_sad_epu8(_mm256_and_si256(p, inside), row_zero());
}
POVSLAM_INLINE Row row_weigh(Row p, Row weights) {
  return _mm256_maddubs_epi16(p, weights);
}
POVSLAM_INLINE Row add64(Row a, Row b) {
  return _mm256_add_epi64(a, b);
}
POVSLAM_INLINE Row sub64(Row a, Row b) {
  return _mm256_sub_epi64(a, b);
}
POVSLAM_INLINE Row add_16(Row a, Row b) {
  return _mm256_add_epi16(a, b);
}
POVSLAM_INLINE Row add32(Row a, Row b) {
  return _mm256_add_epi32(a, b);
}
POVSLAM_INLINE Row widen(Row a) {
  return _mm256_madd_epi16(a, _mm256_set1_epi16(1));
}
#else
struct Row {
  __m128i low, high;
};
POVSLAM_INLINE Row row_zero() {
  return {_mm_setzero_si128(), _mm_setzero_si128()};
}
POVSLAM_INLINE Row row_load(const void* p) {
  const __m128i_u* q = static_cast<const __m128i_u*>(p);
  return {_mm_loadu_si128(q), _mm_loadu_si128(q + 1)};
}
POVSLAM_INLINE Row row_sum(Row p, Row inside) {
  return {_mm_sad_epu8(_mm_and_si128(p.low, inside.low), _mm_setzero_si128()),
          _mm_sad_epu8(_mm_and_si128(p.high, inside.high), _mm_setzero_si128())};
}
POVSLAM_INLINE Row row_weigh(Row p, Row weights) {
  return {_mm_maddubs_epi16(p.low, weights.low), _mm_maddubs_epi16(p.high, weights.high)};
}
POVSLAM_INLINE Row add64(Row a, Row b) {
  return {_mm_add_epi64(a.low, b.low), _mm_add_epi64(a.high, b.high)};
}
POVSLAM_INLINE Row sub64(Row a, Row b) {
  return {_mm_sub_epi64(a.low, b.low), _mm_sub_epi64(a.high, b.high)};
}
POVSLAM_INLINE Row add_16(Row a, Row b) {
  return {_mm_add_epi16(a.low, b.low), _mm_add_epi16(a.high, b.high)};
}
POVSLAM_INLINE Row add32(Row a, Row b) {
  return {_mm_add_epi32(a.low, b.low), _mm_add_epi32(a.high, b.high)};
}
POVSLAM_INLINE Row widen(Row a) {
  return {_mm_madd_epi16(a.low, _mm_set1_epi16(1)), _mm_madd_epi16(a.high, _mm_set1_epi16(1))};
}
#endif

POVSLAM_INLINE int32_t total32(Row a) {
  alignas(32) int32_t lanes[8];
  __builtin_memcpy(lanes, &a, sizeof(lanes));
  int32_t sum = 0;
  for (int k = 0; k < 8; ++k) sum += lanes[k];
  return sum;
}

POVSLAM_INLINE int32_t total64(Row a) {
  alignas(32) int64_t lanes[4];
  __builtin_memcpy(lanes, &a, sizeof(lanes));
  return static_cast<int32_t>(lanes[0] + lanes[1] + lanes[2] + lanes[3]);
}

}  // namespace

PatchMoments patch_moments(const uint8_t* centre, int64_t stride, const PatchMask* mask) {
  const uint8_t* middle = centre - kPatchRadius;
  const int8_t(*column)[kPatchColumns] = mask->column + kPatchRadius;
  const uint8_t(*inside)[kPatchColumns] = mask->inside + kPatchRadius;
  Row x = widen(row_weigh(row_load(middle), row_load(column[0])));
  Row y = row_zero(), running = row_zero();
  // From the outer rows inwards: adding the running sum each time weighs row v by v without a multiplication.
  for (int v = kPatchRadius; v >= 1; --v) {
    const Row below = row_load(middle + v * stride), above = row_load(middle - v * stride);
    const Row in = row_load(inside[v]), weights = row_load(column[v]);
    running = add64(running, sub64(row_sum(below, in), row_sum(above, in)));
    y = add64(y, running);
    x = add32(x, widen(add_16(row_weigh(below, weights), row_weigh(above, weights))));
  }
  return {total32(x), total64(y)};
}

void brief(const uint8_t* centre, const int32_t* first, const int32_t* second, uint64_t* bits) {
  for (int word = 0; word < kBriefBits / 64; ++word) {
    uint64_t part[4] = {0, 0, 0, 0};
    for (int k = 15; k >= 0; --k) {
      for (int lane = 0; lane < 4; ++lane) {
        const int at = 64 * word + 16 * lane + k;
        part[lane] = part[lane] + part[lane] + (centre[first[at]] < centre[second[at]] ? 1U : 0U);
      }
    }
    bits[word] = part[0] | part[1] << 16 | part[2] << 32 | part[3] << 48;
  }
}

}  // namespace povslam::POVSLAM_ISA
