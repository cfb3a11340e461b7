// Buckets of feature indices over the rectified image, for searching a window without walking all features.
// Capacity fixed at construction; rebuilt for each frame without allocation.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace povslam {

class FeatureGrid {
 public:
  FeatureGrid(int max_features, float min_x, float min_y, float max_x, float max_y);

  void build(std::span<const float> x,
             std::span<const float> y);  // px, rectified; outside: clamped to the border cells

  // Calls visit(index) for every feature in cells that touch the square of half-width radius_px around (x, y).
  template <class Visit>
  void for_each_near(float x, float y, float radius_px, Visit&& visit) const {
    if (x + radius_px < min_x_ || y + radius_px < min_y_ || x - radius_px > max_x_ || y - radius_px > max_y_) return;
    const int c0 = column(x - radius_px), c1 = column(x + radius_px);
    const int r0 = row(y - radius_px), r1 = row(y + radius_px);
    for (int r = r0; r <= r1; ++r) {
      const std::int32_t first = start_[static_cast<std::size_t>(r * columns_ + c0)];
      const std::int32_t last = start_[static_cast<std::size_t>(r * columns_ + c1 + 1)];
      for (std::int32_t k = first; k < last; ++k) visit(order_[static_cast<std::size_t>(k)]);
    }
  }

 private:
  static constexpr float kCellPx = 16.0F;
  int column(float x) const {
    return std::clamp(static_cast<int>(std::floor((x - min_x_) / kCellPx)), 0, columns_ - 1);
  }
  int row(float y) const { return std::clamp(static_cast<int>(std::floor((y - min_y_) / kCellPx)), 0, rows_ - 1); }

  float min_x_, min_y_, max_x_, max_y_;
  int columns_ = 0, rows_ = 0;
  std::vector<std::int32_t> start_;  // columns * rows + 1 prefix sums into order_
  std::vector<std::int32_t> order_;
  std::vector<std::int32_t> cell_of_;
};

}  // namespace povslam
