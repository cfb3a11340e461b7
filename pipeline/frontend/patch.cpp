#include "pipeline/frontend/patch.hpp"

#include <cmath>

namespace povslam {

namespace {

constexpr int kSide = 10;           // px: window that is fitted
constexpr int kBorder = kSide + 2;  // with a rim for gradients
constexpr int kPixels = kSide * kSide;
constexpr int kMaxIterations = 12;
constexpr float kSettledPx = 0.01F;

struct Template {
  float value[kPixels];
  float gradient_x[kPixels], gradient_y[kPixels];
  float mean = 0.0F, deviation = 0.0F;  // deviation: root of the sum of squares about the mean
  float inverse[3] = {};                // of the 2x2 normal matrix: xx, xy, yy
};

// Samples the patch on the image's grid. False when the warp needs more of the patch than there is.
bool sample(const Patch& patch, const float a[4], float* out) {
  const float middle = 0.5F * (kBorder - 1);
  const float reach_x = middle * (std::abs(a[0]) + std::abs(a[1])),
              reach_y = middle * (std::abs(a[2]) + std::abs(a[3]));
  const float centre = static_cast<float>(kPatchSide / 2);
  if (reach_x > centre - 1.5F || reach_y > centre - 1.5F) return false;
  for (int v = 0; v < kBorder; ++v) {
    for (int u = 0; u < kBorder; ++u) {
      const float du = static_cast<float>(u) - middle, dv = static_cast<float>(v) - middle;
      const float x = centre + a[0] * du + a[1] * dv, y = centre + a[2] * du + a[3] * dv;
      const int ix = static_cast<int>(x), iy = static_cast<int>(y);
      const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
      const std::uint8_t* p = patch.pixels + iy * kPatchSide + ix;
      const float top = static_cast<float>(p[0]) + fx * static_cast<float>(p[1] - p[0]);
      const float low = static_cast<float>(p[kPatchSide]) + fx * static_cast<float>(p[kPatchSide + 1] - p[kPatchSide]);
      out[v * kBorder + u] = top + fy * (low - top);
    }
  }
  return true;
}

bool make_template(const Patch& patch, const float a[4], Template& t) {
  float wide[kBorder * kBorder];
  if (!sample(patch, a, wide)) return false;
  float sum = 0.0F;
  for (int v = 0; v < kSide; ++v) {
    for (int u = 0; u < kSide; ++u) {
      const float* p = wide + (v + 1) * kBorder + u + 1;
      const int k = v * kSide + u;
      t.value[k] = p[0];
      t.gradient_x[k] = 0.5F * (p[1] - p[-1]);
      t.gradient_y[k] = 0.5F * (p[kBorder] - p[-kBorder]);
      sum += p[0];
    }
  }
  t.mean = sum / kPixels;
  float xx = 0.0F, xy = 0.0F, yy = 0.0F, square = 0.0F;
  for (int k = 0; k < kPixels; ++k) {
    xx += t.gradient_x[k] * t.gradient_x[k];
    xy += t.gradient_x[k] * t.gradient_y[k];
    yy += t.gradient_y[k] * t.gradient_y[k];
    t.value[k] -= t.mean;
    square += t.value[k] * t.value[k];
  }
  t.deviation = std::sqrt(square);
  const float determinant = xx * yy - xy * xy, trace = xx + yy;
  const float smallest = 0.5F * (trace - std::sqrt(std::fmax(0.0F, trace * trace - 4.0F * determinant)));
  if (smallest < 4.0F * kPixels) return false;  // structure in one direction only slides along itself
  t.inverse[0] = yy / determinant;
  t.inverse[1] = -xy / determinant;
  t.inverse[2] = xx / determinant;
  return true;
}

// The image's window around (x, y), bilinear with one pair of fractions for all pixels.
void read_window(const PyramidLevel& level, float x, float y, float* out) {
  const float middle = 0.5F * (kSide - 1);
  const float left = x - middle, top = y - middle;
  const int ix = static_cast<int>(std::floor(left)), iy = static_cast<int>(std::floor(top));
  const float fx = left - static_cast<float>(ix), fy = top - static_cast<float>(iy);
  const float w00 = (1.0F - fx) * (1.0F - fy), w01 = fx * (1.0F - fy), w10 = (1.0F - fx) * fy, w11 = fx * fy;
  for (int v = 0; v < kSide; ++v) {
    const std::uint8_t* p = level.pixels + (iy + v) * level.stride + ix;
    const std::uint8_t* q = p + level.stride;
    for (int u = 0; u < kSide; ++u) {
      out[v * kSide + u] = w00 * static_cast<float>(p[u]) + w01 * static_cast<float>(p[u + 1]) +
                           w10 * static_cast<float>(q[u]) + w11 * static_cast<float>(q[u + 1]);
    }
  }
}

bool inside(const PyramidLevel& level, float x, float y) {
  constexpr float kReach = 0.5F * kSide + 1.0F;
  return x >= kReach && y >= kReach && x < static_cast<float>(level.width) - kReach - 1.0F &&
         y < static_cast<float>(level.height) - kReach - 1.0F;
}

}  // namespace

bool cut_patch(const PyramidLevel& level, float x, float y, Patch& patch) {
  constexpr int kHalf = kPatchSide / 2;
  const float left = x - kHalf, top = y - kHalf;
  const int ix = static_cast<int>(std::floor(left)), iy = static_cast<int>(std::floor(top));
  if (ix < 0 || iy < 0 || ix + kPatchSide + 1 > level.width || iy + kPatchSide + 1 > level.height) return false;
  const int fx = static_cast<int>((left - static_cast<float>(ix)) * 256.0F);
  const int fy = static_cast<int>((top - static_cast<float>(iy)) * 256.0F);
  for (int v = 0; v < kPatchSide; ++v) {
    const std::uint8_t* p = level.pixels + (iy + v) * level.stride + ix;
    const std::uint8_t* q = p + level.stride;
    for (int u = 0; u < kPatchSide; ++u) {
      const int upper = p[u] * (256 - fx) + p[u + 1] * fx, lower = q[u] * (256 - fx) + q[u + 1] * fx;
      patch.pixels[v * kPatchSide + u] = static_cast<std::uint8_t>((upper * (256 - fy) + lower * fy + (1 << 15)) >> 16);
    }
  }
  return true;
}

PatchPlace find_patch(const Patch& patch, const float patch_per_image[4], const PyramidLevel& level, float x, float y,
                      float max_shift_px) {
  PatchPlace place{x, y, 0.0F, false};
  Template t;
  if (!inside(level, x, y) || !make_template(patch, patch_per_image, t)) return place;
  float window[kPixels];
  for (int i = 0; i < kMaxIterations; ++i) {
    read_window(level, place.x, place.y, window);
    float sum = 0.0F;
    for (int k = 0; k < kPixels; ++k) sum += window[k];
    const float mean = sum / kPixels;
    float square = 0.0F, product = 0.0F;
    for (int k = 0; k < kPixels; ++k) {
      window[k] -= mean;
      square += window[k] * window[k];
      product += window[k] * t.value[k];
    }
    if (square <= 0.0F) return place;
    place.correlation = product / (std::sqrt(square) * t.deviation);
    const float gain = t.deviation / std::sqrt(square);  // exposure
    float gx = 0.0F, gy = 0.0F;
    for (int k = 0; k < kPixels; ++k) {
      const float error = gain * window[k] - t.value[k];
      gx += error * t.gradient_x[k];
      gy += error * t.gradient_y[k];
    }
    const float step_x = t.inverse[0] * gx + t.inverse[1] * gy, step_y = t.inverse[1] * gx + t.inverse[2] * gy;
    place.x -= step_x;
    place.y -= step_y;
    const float shift_x = place.x - x, shift_y = place.y - y;
    if (!(shift_x * shift_x + shift_y * shift_y <= max_shift_px * max_shift_px)) return place;
    if (!inside(level, place.x, place.y)) return place;
    if (step_x * step_x + step_y * step_y < kSettledPx * kSettledPx) {
      place.converged = true;
      return place;
    }
  }
  return place;
}

}  // namespace povslam
