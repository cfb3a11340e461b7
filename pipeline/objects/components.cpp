#include "pipeline/objects/components.hpp"

#include <algorithm>
#include <cmath>

namespace povslam {

std::int32_t ComponentFinder::root(std::int32_t cell) {
  std::int32_t* parent = parent_.data();
  while (parent[cell] != cell) cell = parent[cell] = parent[parent[cell]];
  return cell;
}

void ComponentFinder::join(std::int32_t a, std::int32_t b) {
  a = root(a), b = root(b);
  // The earlier cell leads, so that components are met first at their root.
  if (a != b) parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
}

const std::vector<Component>& ComponentFinder::find(const ImageU16& value, const ImageF& depth, double step_m,
                                                    double step_share) {
  width_ = value.width();
  parent_.resize(value.size());
  label_.assign(value.size(), -1);
  components_.clear();
  const auto connected = [&](std::size_t a, std::size_t b) {
    const float za = depth.data()[a], zb = depth.data()[b];
    return value.data()[a] == value.data()[b] &&
           static_cast<double>(std::abs(za - zb)) < step_m + step_share * static_cast<double>(std::min(za, zb));
  };
  for (int y = 0; y < value.height(); ++y) {
    for (int x = 0; x < width_; ++x) {
      const std::size_t i = index(x, y);
      parent_[i] = static_cast<std::int32_t>(i);
      if (value.data()[i] == 0) continue;
      if (x > 0 && connected(i - 1, i)) join(static_cast<std::int32_t>(i - 1), static_cast<std::int32_t>(i));
      if (y > 0 && connected(index(x, y - 1), i)) {
        join(static_cast<std::int32_t>(index(x, y - 1)), static_cast<std::int32_t>(i));
      }
    }
  }
  for (int y = 0; y < value.height(); ++y) {
    for (int x = 0; x < width_; ++x) {
      const std::size_t i = index(x, y);
      if (value.data()[i] == 0) continue;
      const auto first = static_cast<std::size_t>(root(static_cast<std::int32_t>(i)));
      if (first == i) {
        label_[i] = static_cast<std::int32_t>(components_.size());
        components_.push_back({value.data()[i], 0, x, y, x, y});
      }
      label_[i] = label_[first];
      Component& part = components_[static_cast<std::size_t>(label_[i])];
      ++part.cells;
      part.x_min = std::min(part.x_min, x), part.x_max = std::max(part.x_max, x);
      part.y_max = y;
    }
  }
  return components_;
}

}  // namespace povslam
