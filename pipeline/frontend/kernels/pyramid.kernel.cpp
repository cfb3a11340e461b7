// Shrinking by bilinear interpolation and smoothing, in integers.
#include "pipeline/frontend/kernels/kernels.hpp"
#include "pipeline/frontend/kernels/simd.hpp"

namespace povslam::POVSLAM_ISA {

void shrink_row(const uint8_t* source, const ShrinkTaps* taps, int groups, uint16_t* out) {
  for (int k = 0; k < groups; ++k) {
    const ShrinkTaps& t = taps[k];
    const __m128i pixels = _mm_loadu_si128(reinterpret_cast<const __m128i_u*>(source + t.base));
    const __m128i picked = _mm_shuffle_epi8(pixels, _mm_loadu_si128(reinterpret_cast<const __m128i_u*>(t.shuffle)));
    const __m128i sums = _mm_maddubs_epi16(picked, _mm_loadu_si128(reinterpret_cast<const __m128i_u*>(t.weight)));
    _mm_storeu_si128(reinterpret_cast<__m128i_u*>(out + 8 * k), sums);
  }
}

void blend_rows(const uint16_t* upper, const uint16_t* lower, int weight, int width, uint8_t* out) {
  const Bytes factor = fill16(weight * 256), half = fill16(64);
  for (int x = 0; x < width; x += kLanes) {
    Bytes part[2];
    for (int k = 0; k < 2; ++k) {
      const Bytes a = load16(upper + x + k * kLanes / 2), b = load16(lower + x + k * kLanes / 2);
      part[k] = shift_right16<7>(add16(add16(a, multiply_round16(sub16(b, a), factor)), half));
    }
    // pack() works within 128-bit lanes: put the halves side by side first.
#if defined(__AVX512BW__)
    store(out + x,
          _mm512_maskz_permutexvar_epi64(0xFF, _mm512_setr_epi64(0, 2, 4, 6, 1, 3, 5, 7), pack(part[0], part[1])));
#elif defined(__AVX2__)
    store(out + x, _mm256_permute4x64_epi64(pack(part[0], part[1]), 0xD8));
#else
    store(out + x, pack(part[0], part[1]));
#endif
  }
}

namespace {

// Weighted sum of seven byte vectors, weights summing to 128, rounded.
struct Taps {
  Bytes pair01, pair23, pair45, pair6;
};
POVSLAM_INLINE Taps make_taps() {
  return {fill16(9 + 256 * 17), fill16(24 + 256 * 28), fill16(24 + 256 * 17), fill16(9)};
}

template <bool kHigh>
POVSLAM_INLINE Bytes interleave(Bytes a, Bytes b) {
  return kHigh ? unpack_high(a, b) : unpack_low(a, b);
}

template <bool kHigh>
POVSLAM_INLINE Bytes weigh_half(const Bytes* p, const Taps& taps) {
  const Bytes sum = add16(add16(multiply_pairs(interleave<kHigh>(p[0], p[1]), taps.pair01),
                                multiply_pairs(interleave<kHigh>(p[2], p[3]), taps.pair23)),
                          add16(multiply_pairs(interleave<kHigh>(p[4], p[5]), taps.pair45),
                                multiply_pairs(interleave<kHigh>(p[6], zero()), taps.pair6)));
  return shift_right16<7>(add16(sum, fill16(64)));
}

POVSLAM_INLINE Bytes weigh(const uint8_t* first, int64_t step, const Taps& taps) {
  Bytes p[7];
  for (int k = 0; k < 7; ++k) p[k] = load(first + k * step);
  return pack(weigh_half<false>(p, taps), weigh_half<true>(p, taps));
}

}  // namespace

void smooth_row(const uint8_t* source, int64_t stride, int width, uint8_t* scratch, uint8_t* out) {
  const Taps taps = make_taps();
  for (int x = 0; x < width + 6; x += kLanes) store(scratch + x, weigh(source - 3 - 3 * stride + x, stride, taps));
  for (int x = 0; x < width; x += kLanes) store(out + x, weigh(scratch + x, 1, taps));
}

}  // namespace povslam::POVSLAM_ISA
