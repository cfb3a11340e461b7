#include "pipeline/objects/segment_boxes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace povslam {

namespace {

constexpr int kStrides[] = {8, 16, 32};
constexpr float kLargestLog = 12.0F;  // of a side in strides: beyond any image

std::vector<DetectedBox> without_doubles(std::vector<DetectedBox> boxes, float max_overlap) {
  std::stable_sort(boxes.begin(), boxes.end(),
                   [](const DetectedBox& a, const DetectedBox& b) { return a.score > b.score; });
  std::vector<DetectedBox> kept;
  for (const DetectedBox& box : boxes) {
    const bool is_double = std::any_of(kept.begin(), kept.end(), [&](const DetectedBox& other) {
      return other.class_index == box.class_index && intersection_over_union(other, box) > max_overlap;
    });
    if (!is_double) kept.push_back(box);
  }
  return kept;
}

}  // namespace

float intersection_over_union(const DetectedBox& a, const DetectedBox& b) {
  const float width = std::min(a.x + a.width, b.x + b.width) - std::max(a.x, b.x);
  const float height = std::min(a.y + a.height, b.y + b.height) - std::max(a.y, b.y);
  if (width <= 0.0F || height <= 0.0F) return 0.0F;
  const float both = width * height;
  return both / (a.area() + b.area() - both);
}

std::vector<DetectedBox> decode_yolox(std::span<const float> rows, int input_px, int num_classes, float scale,
                                      const BoxOptions& options) {
  const std::size_t length = 5 + static_cast<std::size_t>(num_classes);
  std::size_t expected = 0;
  for (const int stride : kStrides) expected += static_cast<std::size_t>((input_px / stride) * (input_px / stride));
  if (rows.size() != expected * length) return {};
  std::vector<DetectedBox> boxes;
  const float* row = rows.data();
  const auto min_score = static_cast<float>(options.min_score);
  for (const int stride : kStrides) {
    const int cells = input_px / stride;
    for (int cell = 0; cell < cells * cells; ++cell, row += length) {
      if (!(row[4] >= min_score)) continue;
      const float* best = std::max_element(row + 5, row + length);
      const float score = row[4] * *best, unit = static_cast<float>(stride) / scale;
      if (!(score >= min_score && row[2] < kLargestLog && row[3] < kLargestLog)) continue;
      const float width = std::exp(row[2]) * unit, height = std::exp(row[3]) * unit;
      const float x = (row[0] + static_cast<float>(cell % cells)) * unit - 0.5F * width;
      const float y = (row[1] + static_cast<float>(cell / cells)) * unit - 0.5F * height;
      if (!std::isfinite(x + y)) continue;
      boxes.push_back({static_cast<int>(best - row - 5), score, x, y, width, height});
    }
  }
  return without_doubles(std::move(boxes), static_cast<float>(options.max_overlap));
}

}  // namespace povslam
