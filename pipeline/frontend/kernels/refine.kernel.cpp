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

// exp(-k^2 / 8)
constexpr float kGaussian[kTaps + 1] = {1.0F, 0.88249690F, 0.60653066F, 0.32465247F, 0.13533528F};

struct Products {
  alignas(64) float xx[kRows][kColumns], xy[kRows][kColumns], yy[kRows][kColumns];
};

struct Responses {
  alignas(64) float at[kPeaks][kResponseColumns];
};

// Products of the Sobel gradients; (0, 0) is the pixel kRows / 2 up and left of the corner.
POVSLAM_INLINE void gradient_products(const uint8_t* corner, int64_t stride, Products& out) {
  for (int row = 0; row < kRows; ++row) {
    const uint8_t* p = corner + (row - kRows / 2) * stride - kRows / 2 - 1;
    int16_t sum[kColumns + 2], difference[kColumns + 2];
    for (int k = 0; k < kColumns + 2; ++k) {
      sum[k] = static_cast<int16_t>(p[k - stride] + 2 * p[k] + p[k + stride]);
      difference[k] = static_cast<int16_t>(p[k + stride] - p[k - stride]);
    }
#pragma omp simd
    for (int k = 0; k < kColumns; ++k) {
      const float x = static_cast<float>(sum[k + 2] - sum[k]);
      const float y = static_cast<float>(difference[k] + 2 * difference[k + 1] + difference[k + 2]);
      out.xx[row][k] = x * x;
      out.xy[row][k] = x * y;
      out.yy[row][k] = y * y;
    }
  }
}

POVSLAM_INLINE void smooth_down(const float (*in)[kColumns], float* out) {
#pragma omp simd
  for (int k = 0; k < kColumns; ++k) {
    float sum = kGaussian[0] * in[kTaps][k];
    for (int tap = 1; tap <= kTaps; ++tap) sum += kGaussian[tap] * (in[kTaps - tap][k] + in[kTaps + tap][k]);
    out[k] = sum;
  }
}

POVSLAM_INLINE float smooth_across(const float* in) {
  float sum = kGaussian[0] * in[kTaps];
  for (int tap = 1; tap <= kTaps; ++tap) sum += kGaussian[tap] * (in[kTaps - tap] + in[kTaps + tap]);
  return sum;
}

POVSLAM_INLINE void respond(const Products& products, Responses& out) {
  for (int row = 0; row < kPeaks; ++row) {
    alignas(64) float xx[kColumns], xy[kColumns], yy[kColumns];
    smooth_down(products.xx + row, xx);
    smooth_down(products.xy + row, xy);
    smooth_down(products.yy + row, yy);
#pragma omp simd
    for (int k = 0; k < kResponseColumns; ++k) {
      const float a = smooth_across(xx + k), b = smooth_across(xy + k), c = smooth_across(yy + k);
      out.at[row][k] = (a * c - b * b) / (a + c + 1.0F);
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
