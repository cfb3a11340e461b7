#include "pipeline/objects/name_segments.hpp"

#include <algorithm>
#include <cmath>

namespace povslam {

namespace {

struct Pixels {
  int x_begin = 0, x_end = 0, y_begin = 0, y_end = 0;
};

Pixels pixels_of(const DetectedBox& box, const ImageU16& image) {
  const auto bound = [](float value, int size) {
    return static_cast<int>(std::lround(std::clamp(value, 0.0F, static_cast<float>(size))));
  };
  return {bound(box.x, image.width()), bound(box.x + box.width, image.width()), bound(box.y, image.height()),
          bound(box.y + box.height, image.height())};
}

// Pixels of each segment among those; the last entry counts all that have an owner.
std::vector<int> count(const ImageU16& instances, const Pixels& area, std::size_t num_segments) {
  std::vector<int> counts(num_segments + 1, 0);
  for (int y = area.y_begin; y < area.y_end; ++y) {
    const std::uint16_t* row = instances.row(y);
    for (int x = area.x_begin; x < area.x_end; ++x) {
      if (row[x] == kNobody) continue;
      ++counts.back();
      const std::size_t segment = static_cast<std::size_t>(row[x]) - kFirstInstance;
      if (row[x] >= kFirstInstance && segment < num_segments) ++counts[segment];
    }
  }
  return counts;
}

}  // namespace

std::vector<SegmentName> name_segments(std::span<const DetectedBox> boxes, const ImageU16& instances,
                                       std::size_t num_segments, const NameOptions& options) {
  std::vector<SegmentName> names(num_segments);
  std::vector<float> smallest(num_segments, 0.0F);  // area of the box that named it
  const std::vector<int> whole = count(instances, {0, instances.width(), 0, instances.height()}, num_segments);
  for (const DetectedBox& box : boxes) {
    if (!std::isfinite(box.x + box.y + box.width + box.height) || box.width <= 0.0F || box.height <= 0.0F) continue;
    const std::vector<int> inside = count(instances, pixels_of(box, instances), num_segments);
    for (std::size_t i = 0; i < num_segments; ++i) {
      if (inside[i] == 0 || inside[i] < options.inside * whole[i]) continue;
      if (inside[i] < options.filled * inside.back()) continue;
      if (names[i].class_index >= 0 && smallest[i] <= box.area()) continue;
      names[i] = {box.class_index, box.score};
      smallest[i] = box.area();
    }
  }
  return names;
}

}  // namespace povslam
