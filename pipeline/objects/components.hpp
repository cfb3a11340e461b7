// Connected parts of an image: 4-neighbours of one value and nearly one depth.
#pragma once

#include <vector>

#include "pipeline/mapping/depth_view.hpp"

namespace povslam {

struct Component {
  std::uint16_t value = 0;
  int cells = 0;
  int x_min = 0, y_min = 0, x_max = 0, y_max = 0;
};

class ComponentFinder {
 public:
  // value 0: belongs to nothing. Neighbours differ by at most step_m + step_share * depth. In order of their first
  // cell, row by row. Valid until the next call.
  const std::vector<Component>& find(const ImageU16& value, const ImageF& depth, double step_m, double step_share);
  std::int32_t component_at(int x, int y) const { return label_[index(x, y)]; }  // -1: none

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  std::int32_t root(std::int32_t cell);
  void join(std::int32_t a, std::int32_t b);

  int width_ = 0;
  std::vector<std::int32_t> parent_;  // per cell, union-find
  std::vector<std::int32_t> label_;   // per cell: component
  std::vector<Component> components_;
};

}  // namespace povslam
