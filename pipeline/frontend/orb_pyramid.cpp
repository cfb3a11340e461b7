#include "pipeline/frontend/orb_pyramid.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "pipeline/base/expects.hpp"

namespace povslam {
namespace {

constexpr int kOne = 128;  // of the interpolation weights

int round_up(int value, int step) {
  return (value + step - 1) / step * step;
}

// A row's pixels, the left border of the next row and room for whole vectors. Strides that are a multiple of 256
// would put a patch's rows into few cache sets.
std::int64_t row_stride(int width) {
  const int stride = round_up(width, kKernelSlack) + kKernelSlack;
  return stride % 256 == 0 ? stride + kKernelSlack : stride;
}

struct Tap {
  int first;
  int weight_second;
};

// Bilinear tap of output `i` when one output pixel spans `scale` source pixels.
Tap bilinear_tap(int i, double scale) {
  const double position = (i + 0.5) * scale - 0.5;
  const int first = static_cast<int>(std::floor(position));
  // kOne itself does not fit a signed byte.
  return {first, std::clamp(static_cast<int>(std::lround((position - first) * kOne)), 1, kOne - 1)};
}

ShrinkTaps eight_taps(int group, double scale) {
  ShrinkTaps taps{};
  taps.base = bilinear_tap(8 * group, scale).first;
  for (int k = 0; k < 8; ++k) {
    const Tap tap = bilinear_tap(8 * group + k, scale);
    EXPECTS(tap.first + 1 - taps.base < 16);
    taps.shuffle[2 * k] = static_cast<std::uint8_t>(tap.first - taps.base);
    taps.shuffle[2 * k + 1] = static_cast<std::uint8_t>(tap.first - taps.base + 1);
    taps.weight[2 * k] = static_cast<std::int8_t>(kOne - tap.weight_second);
    taps.weight[2 * k + 1] = static_cast<std::int8_t>(tap.weight_second);
  }
  return taps;
}

}  // namespace

OrbPyramid::OrbPyramid(int width, int height, int num_levels, double scale_factor, int min_edge_px) {
  EXPECTS(width >= 1 && height >= 1 && num_levels >= 1 && num_levels <= kMaxPyramidLevels);
  EXPECTS(scale_factor > 1.0 && scale_factor <= 1.8);
  const std::int64_t stride = row_stride(width);
  std::size_t size = kKernelSlack;
  for (int l = 0; l < num_levels; ++l) {
    const double scale = std::pow(scale_factor, l);
    PyramidLevel level;
    level.width = static_cast<int>(std::lround(width / scale));
    level.height = static_cast<int>(std::lround(height / scale));
    if (l > 0 && std::min(level.width, level.height) < min_edge_px) break;
    level.stride = stride;
    level.scale = static_cast<float>(scale);
    levels_.push_back(level);
    offsets_.push_back(size + static_cast<std::size_t>(kOrbBorder) * stride);
    size += static_cast<std::size_t>(level.height + 2 * kOrbBorder) * stride;
  }
  buffer_.assign(size + kKernelSlack, 0);
  shrinks_.resize(levels_.size());
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    levels_[l].pixels = buffer_.data() + offsets_[l];
    if (l == 0) continue;
    for (int k = 0; k < (levels_[l].width + 7) / 8; ++k) shrinks_[l].columns.push_back(eight_taps(k, scale_factor));
    for (int y = 0; y < levels_[l].height; ++y) {
      const Tap tap = bilinear_tap(y, scale_factor);
      shrinks_[l].rows.push_back({tap.first, tap.weight_second});
    }
  }
  for (auto& sums : row_sums_) sums.assign(static_cast<std::size_t>(width) + 2 * kKernelSlack, 0);
}

void OrbPyramid::build(const FrontendKernels& kernels, const std::uint8_t* grey, std::int64_t grey_stride) {
  for (int y = 0; y < levels_[0].height; ++y) {
    std::memcpy(pixels(0) + y * levels_[0].stride, grey + y * grey_stride, static_cast<std::size_t>(levels_[0].width));
  }
  fill_border(0);
  for (int l = 1; l < static_cast<int>(levels_.size()); ++l) {
    shrink(kernels, l);
    fill_border(l);
  }
}

void OrbPyramid::shrink(const FrontendKernels& kernels, int level) {
  const PyramidLevel& from = levels_[level - 1];
  const PyramidLevel& to = levels_[level];
  const Shrink& taps = shrinks_[level];
  std::uint16_t* sums[2] = {row_sums_[0].data(), row_sums_[1].data()};
  int held[2] = {-1, -1};  // source rows in `sums`
  for (int y = 0; y < to.height; ++y) {
    const RowTaps& row = taps.rows[y];
    if (held[1] == row.upper) {
      std::swap(sums[0], sums[1]);
      std::swap(held[0], held[1]);
    }
    for (int k = 0; k < 2; ++k) {
      if (held[k] == row.upper + k) continue;
      kernels.shrink_row(from.pixels + (row.upper + k) * from.stride, taps.columns.data(),
                         static_cast<int>(taps.columns.size()), sums[k]);
      held[k] = row.upper + k;
    }
    kernels.blend_rows(sums[0], sums[1], row.weight, to.width, pixels(level) + y * to.stride);
  }
}

void OrbPyramid::fill_border(int l) {
  const PyramidLevel& level = levels_[l];
  std::uint8_t* const origin = pixels(l);
  for (int y = 0; y < level.height; ++y) {
    std::uint8_t* const row = origin + y * level.stride;
    std::memset(row - kOrbBorder, row[0], kOrbBorder);
    std::memset(row + level.width, row[level.width - 1], kOrbBorder);
  }
  const std::size_t bytes = static_cast<std::size_t>(level.width) + 2 * kOrbBorder;
  const std::uint8_t* const top = origin - kOrbBorder;
  const std::uint8_t* const bottom = top + (level.height - 1) * level.stride;
  for (int k = 1; k <= kOrbBorder; ++k) {
    std::memcpy(origin - kOrbBorder - k * level.stride, top, bytes);
    std::memcpy(origin - kOrbBorder + (level.height - 1 + k) * level.stride, bottom, bytes);
  }
}

}  // namespace povslam
