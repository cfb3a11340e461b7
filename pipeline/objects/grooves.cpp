#include "pipeline/objects/grooves.hpp"

#include <cmath>

namespace povslam {
namespace {

constexpr int kRows = 12;                       // above and below, that are averaged
constexpr int kInner = 1, kNear = 3, kFar = 7;  // columns: the groove's, and from … to of either side
constexpr double kSigmas = 3.0;
constexpr double kShallowest_m = 0.005;
constexpr float kFilled = 0.6F;  // of each window
constexpr int kEnd = 6;          // rows without evidence that a groove may pass…
constexpr int kLong = 8;         // …and, one at least so long, go on beyond its ends

}  // namespace

void GrooveFinder::sum_columns(const ImageU16& value, const ImageF& depth_m) {
  width_ = value.width(), height_ = value.height();
  const std::size_t stride = static_cast<std::size_t>(width_) + 1;
  depth_sum_.assign(stride * (static_cast<std::size_t>(height_) + 1), 0.0);
  count_.assign(depth_sum_.size(), 0);
  for (int y = 0; y < height_; ++y) {
    double row_sum = 0.0;
    std::int32_t row_count = 0;
    const std::size_t above = static_cast<std::size_t>(y) * stride;
    for (int x = 0; x < width_; ++x) {
      const float z = depth_m.at(x, y);
      if (value.at(x, y) != 0 && z > 0.0F) {
        row_sum += 1.0 / static_cast<double>(z);
        ++row_count;
      }
      const std::size_t at = above + static_cast<std::size_t>(x) + 1;
      depth_sum_[at + stride] = depth_sum_[at] + row_sum;
      count_[at + stride] = count_[at] + row_count;
    }
  }
}

GrooveFinder::Sum GrooveFinder::mean(int x, int y, int from, int to) const {
  const std::size_t stride = static_cast<std::size_t>(width_) + 1;
  const std::size_t top = static_cast<std::size_t>(std::max(0, y - kRows)) * stride;
  const std::size_t bottom = static_cast<std::size_t>(std::min(height_, y + kRows + 1)) * stride;
  const auto left = static_cast<std::size_t>(x + from), right = static_cast<std::size_t>(x + to + 1);
  const auto area = [&](const auto& table) {
    return table[bottom + right] - table[bottom + left] - table[top + right] + table[top + left];
  };
  const auto count = static_cast<float>(area(count_));
  if (count == 0.0F) return {};
  return {static_cast<float>(area(depth_sum_)) / count, count};
}

void GrooveFinder::find(const ImageU16& value, const DepthView& view, ImageU8& groove) {
  sum_columns(value, view.depth_m);
  groove.resize(width_, height_);
  groove.fill(0);
  constexpr float kSideArea = kFilled * (kFar - kNear + 1) * (2 * kRows + 1);
  constexpr float kInnerArea = kFilled * (2 * kInner + 1) * (2 * kRows + 1);
  for (int y = 0; y < height_; ++y) {
    for (int x = kFar; x < width_ - kFar; ++x) {
      const std::uint16_t here = value.at(x, y);
      if (here == 0 || value.at(x - kFar, y) != here || value.at(x + kFar, y) != here) continue;
      const Sum left = mean(x, y, -kFar, -kNear), right = mean(x, y, kNear, kFar), inner = mean(x, y, -kInner, kInner);
      if (left.count < kSideArea || right.count < kSideArea || inner.count < kInnerArea) continue;
      const double behind =
          static_cast<double>(0.5F * (left.inverse_depth + right.inverse_depth) - inner.inverse_depth);
      const double noise =
          sigma_ * std::sqrt(1.0 / static_cast<double>(inner.count) + 0.25 / static_cast<double>(left.count) +
                             0.25 / static_cast<double>(right.count));
      const double depth_m = behind / static_cast<double>(inner.inverse_depth * inner.inverse_depth);
      if (behind > kSigmas * noise && depth_m > kShallowest_m) groove.at(x, y) = 1;
    }
  }
  for (int x = 0; x < width_; ++x) close_rows(value, x, groove);
}

// A groove goes on through rows where noise hid it, and one of some length to the end of its thing, where the windows
// ran out of it.
void GrooveFinder::close_rows(const ImageU16& value, int x, ImageU8& groove) const {
  const auto carry_on = [&](int from, int step) {
    for (int y = from, k = 0; k <= kEnd && y >= 0 && y < height_ && value.at(x, y) == value.at(x, from); y += step) {
      groove.at(x, y) = 1;
      ++k;
    }
  };
  int first = -1, last = -height_;
  const auto end = [&] {
    if (first < 0 || last - first < kLong) return;
    carry_on(first, -1);
    carry_on(last, 1);
  };
  for (int y = 0; y < height_; ++y) {
    if (groove.at(x, y) == 0) continue;
    if (y - last > kEnd + 1) {
      end();
      first = y;
    }
    for (int k = std::max(first, last + 1); k < y; ++k) groove.at(x, k) = 1;
    last = y;
  }
  end();
}

}  // namespace povslam
