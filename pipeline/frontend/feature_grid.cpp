#include "pipeline/frontend/feature_grid.hpp"

#include "pipeline/base/expects.hpp"

namespace povslam {

FeatureGrid::FeatureGrid(int max_features, float min_x, float min_y, float max_x, float max_y)
    : min_x_(min_x), min_y_(min_y), max_x_(max_x), max_y_(max_y) {
  EXPECTS(max_x > min_x && max_y > min_y);
  columns_ = static_cast<int>((max_x - min_x) / kCellPx) + 1;
  rows_ = static_cast<int>((max_y - min_y) / kCellPx) + 1;
  start_.resize(static_cast<std::size_t>(columns_) * rows_ + 1);
  order_.resize(static_cast<std::size_t>(max_features));
  cell_of_.resize(static_cast<std::size_t>(max_features));
}

void FeatureGrid::build(std::span<const float> x, std::span<const float> y) {
  EXPECTS(x.size() == y.size() && x.size() <= order_.size());
  std::fill(start_.begin(), start_.end(), 0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    cell_of_[i] = row(y[i]) * columns_ + column(x[i]);
    ++start_[static_cast<std::size_t>(cell_of_[i])];
  }
  std::int32_t total = 0;
  for (std::int32_t& count : start_) {  // counts become starts
    const std::int32_t here = count;
    count = total;
    total += here;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    order_[static_cast<std::size_t>(start_[static_cast<std::size_t>(cell_of_[i])]++)] = static_cast<std::int32_t>(i);
  }
  for (std::size_t c = start_.size() - 1; c > 0; --c) start_[c] = start_[c - 1];  // starts were moved to ends
  start_[0] = 0;
}

}  // namespace povslam
