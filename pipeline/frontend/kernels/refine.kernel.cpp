// Sub-pixel position of a corner. A FAST pixel lies somewhere beside the corner that causes it, and hops with noise;
// the peak of det(M) / trace(M) (Noble, 1988; M is the structure tensor under a Gaussian of 2 px) stays.
#include "pipeline/frontend/kernels/kernels.hpp"
#include "pipeline/frontend/kernels/simd.hpp"

namespace povslam::POVSLAM_ISA {
namespace {

enum {
  kReach = 2,                  // px the peak may lie off the FAST pixel
  kPeaks = 2 * kReach + 3,     // edge of the square of responses: the peaks and their neighbours
  kTaps = 4,                   // Gaussian: this many on both sides of the middle
  kRows = kPeaks + 2 * kTaps,  // of the tensor's products
  kColumns = 16,               // kRows columns, filled up to a vector
  kResponseColumns = kColumns - 2 * kTaps
};

#if defined(__AVX2__)
enum { kWidth = 8 };
using Floats = __m256;
POVSLAM_INLINE Floats load_floats(const float* p) {
  return _mm256_loadu_ps(p);
}
POVSLAM_INLINE void store_floats(float* p, Floats a) {
  _mm256_storeu_ps(p, a);
}
POVSLAM_INLINE Floats to_floats(__m128i a) {
  return _mm256_cvtepi32_ps(_mm256_cvtepi16_epi32(a));
}
#else
enum { kWidth = 4 };
using Floats = __m128;
POVSLAM_INLINE Floats load_floats(const float* p) {
  return _mm_loadu_ps(p);
}
POVSLAM_INLINE void store_floats(float* p, Floats a) {
  _mm_storeu_ps(p, a);
}
POVSLAM_INLINE Floats to_floats(__m128i a) {
  return _mm_cvtepi32_ps(_mm_cvtepi16_epi32(a));
}
#endif

// exp(-k^2 / 8)
constexpr float kGaussian[kTaps + 1] = {1.0F, 0.88249690F, 0.60653066F, 0.32465247F, 0.13533528F};

struct Products {
  alignas(64) float xx[kRows][kColumns], xy[kRows][kColumns], yy[kRows][kColumns];
};

struct Responses {
  alignas(64) float at[kPeaks][kResponseColumns];
};

POVSLAM_INLINE __m128i eight_pixels(const uint8_t* p) {
  return _mm_cvtepu8_epi16(_mm_loadl_epi64(reinterpret_cast<const __m128i_u*>(p)));
}

// a + 2 b + c
POVSLAM_INLINE __m128i weigh_three(__m128i a, __m128i b, __m128i c) {
  return _mm_add_epi16(_mm_add_epi16(a, c), _mm_add_epi16(b, b));
}

// Products of the Sobel gradients; [0][0] is the pixel kRows / 2 up and left of the corner.
POVSLAM_INLINE void gradient_products(const uint8_t* corner, int64_t stride, Products& out) {
  for (int column = 0; column < kColumns; column += kWidth) {
    const uint8_t* p = corner - (kRows / 2 + 1) * stride + column - kRows / 2;
    __m128i left[3], middle[3], right[3];  // of three rows
    for (int k = 1; k < 3; ++k, p += stride) {
      left[k] = eight_pixels(p - 1), middle[k] = eight_pixels(p), right[k] = eight_pixels(p + 1);
    }
    for (int row = 0; row < kRows; ++row, p += stride) {
      for (int k = 0; k < 2; ++k) left[k] = left[k + 1], middle[k] = middle[k + 1], right[k] = right[k + 1];
      left[2] = eight_pixels(p - 1), middle[2] = eight_pixels(p), right[2] = eight_pixels(p + 1);
      const Floats x =
          to_floats(_mm_sub_epi16(weigh_three(right[0], right[1], right[2]), weigh_three(left[0], left[1], left[2])));
      const Floats y = to_floats(
          _mm_sub_epi16(weigh_three(left[2], middle[2], right[2]), weigh_three(left[0], middle[0], right[0])));
      store_floats(out.xx[row] + column, x * x);
      store_floats(out.xy[row] + column, x * y);
      store_floats(out.yy[row] + column, y * y);
    }
  }
}

// Gaussian sum of nine vectors, `step` floats apart; `middle` is the fifth.
POVSLAM_INLINE Floats smooth(const float* middle, int step) {
  Floats sum = kGaussian[0] * load_floats(middle);
  for (int tap = 1; tap <= kTaps; ++tap) {
    sum += kGaussian[tap] * (load_floats(middle - tap * step) + load_floats(middle + tap * step));
  }
  return sum;
}

POVSLAM_INLINE void smooth_down(const float (*rows)[kColumns], float (*out)[kColumns]) {
  for (int row = 0; row < kPeaks; ++row) {
    for (int k = 0; k < kColumns; k += kWidth) store_floats(out[row] + k, smooth(rows[row + kTaps] + k, kColumns));
  }
}

// All rows go down before any goes across: unaligned loads of what was just stored would stall.
POVSLAM_INLINE void respond(const Products& products, Responses& out) {
  alignas(64) float xx[kPeaks][kColumns], xy[kPeaks][kColumns], yy[kPeaks][kColumns];
  smooth_down(products.xx, xx);
  smooth_down(products.xy, xy);
  smooth_down(products.yy, yy);
  for (int row = 0; row < kPeaks; ++row) {
    for (int k = 0; k < kResponseColumns; k += kWidth) {
      const Floats a = smooth(xx[row] + kTaps + k, 1), b = smooth(xy[row] + kTaps + k, 1);
      const Floats c = smooth(yy[row] + kTaps + k, 1);
      store_floats(out.at[row] + k, (a * c - b * b) / (a + c + 1.0F));
    }
  }
}

// Least-squares quadratic through the 3x3 responses around a peak.
POVSLAM_INLINE bool fit_peak(const float (*above)[kResponseColumns], int column, CornerPeak* peak) {
  const float *u = above[0] + column, *m = above[1] + column, *d = above[2] + column;
  const float gx = (u[1] - u[-1] + m[1] - m[-1] + d[1] - d[-1]) / 6.0F;
  const float gy = (d[-1] - u[-1] + d[0] - u[0] + d[1] - u[1]) / 6.0F;
  const float xx = (u[-1] - 2.0F * u[0] + u[1] + m[-1] - 2.0F * m[0] + m[1] + d[-1] - 2.0F * d[0] + d[1]) / 3.0F;
  const float yy = (u[-1] - 2.0F * m[-1] + d[-1] + u[0] - 2.0F * m[0] + d[0] + u[1] - 2.0F * m[1] + d[1]) / 3.0F;
  const float xy = (u[-1] - u[1] - d[-1] + d[1]) / 4.0F;
  const float determinant = xx * yy - xy * xy;
  if (!(determinant > 0.0F && xx < 0.0F)) return false;
  peak->x = (xy * gy - yy * gx) / determinant;
  peak->y = (xy * gx - xx * gy) / determinant;
  return peak->x >= -1.0F && peak->x <= 1.0F && peak->y >= -1.0F && peak->y <= 1.0F;
}

}  // namespace

bool refine_corner(const uint8_t* corner, int64_t stride, CornerPeak* peak) {
  Products products;
  Responses responses;
  gradient_products(corner, stride, products);
  respond(products, responses);
  int row = kPeaks / 2, column = kPeaks / 2;
  for (;;) {
    int best_row = row, best_column = column;
    for (int v = row - 1; v <= row + 1; ++v) {
      for (int u = column - 1; u <= column + 1; ++u) {
        if (responses.at[v][u] > responses.at[best_row][best_column]) best_row = v, best_column = u;
      }
    }
    if (best_row == row && best_column == column) break;
    row = best_row;
    column = best_column;
    if (row < 1 || row > kPeaks - 2 || column < 1 || column > kPeaks - 2) return false;
  }
  peak->column = column - kPeaks / 2;
  peak->row = row - kPeaks / 2;
  peak->response = responses.at[row][column];
  return fit_peak(responses.at + row - 1, column, peak);
}

}  // namespace povslam::POVSLAM_ISA
