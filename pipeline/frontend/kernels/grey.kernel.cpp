// Colour to grey, ITU-R BT.601 weights in 15 bits.
#include "pipeline/frontend/kernels/kernels.hpp"
#include "pipeline/frontend/kernels/simd.hpp"

namespace povslam::POVSLAM_ISA {
namespace {

enum { kRed = 9798, kGreen = 19235, kBlue = 3735, kHalf = 16384, kShift = 15 };

// Four pixels as 32-bit sums, from the first 12 of 16 loaded bytes.
POVSLAM_INLINE __m128i four_pixels(const uint8_t* rgb) {
  const __m128i pixels = _mm_loadu_si128(reinterpret_cast<const __m128i_u*>(rgb));
  const __m128i red_green =
      _mm_shuffle_epi8(pixels, _mm_setr_epi8(0, -1, 1, -1, 3, -1, 4, -1, 6, -1, 7, -1, 9, -1, 10, -1));
  const __m128i blue =
      _mm_shuffle_epi8(pixels, _mm_setr_epi8(2, -1, -1, -1, 5, -1, -1, -1, 8, -1, -1, -1, 11, -1, -1, -1));
  const __m128i sum = _mm_add_epi32(_mm_madd_epi16(red_green, _mm_set1_epi32(kRed | kGreen << 16)),
                                    _mm_madd_epi16(blue, _mm_set1_epi32(kBlue)));
  return _mm_srli_epi32(_mm_add_epi32(sum, _mm_set1_epi32(kHalf)), kShift);
}

}  // namespace

void rgb_to_grey(const uint8_t* rgb, uint8_t* grey, int64_t count) {
  int64_t k = 0;
  for (; k + 18 <= count; k += 16) {  // the last load of a block reads four bytes past its 16 pixels
    const __m128i low = _mm_packs_epi32(four_pixels(rgb + 3 * k), four_pixels(rgb + 3 * k + 12));
    const __m128i high = _mm_packs_epi32(four_pixels(rgb + 3 * k + 24), four_pixels(rgb + 3 * k + 36));
    _mm_storeu_si128(reinterpret_cast<__m128i_u*>(grey + k), _mm_packus_epi16(low, high));
  }
  for (; k < count; ++k) {
    const uint8_t* p = rgb + 3 * k;
    grey[k] = static_cast<uint8_t>((kRed * p[0] + kGreen * p[1] + kBlue * p[2] + kHalf) >> kShift);
  }
}

}  // namespace povslam::POVSLAM_ISA
