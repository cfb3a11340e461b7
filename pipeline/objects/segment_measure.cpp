#include "pipeline/objects/segment_measure.hpp"

#include <algorithm>
#include <cmath>

namespace povslam {

namespace {

constexpr int kLookAcross = 6;  // cells without depth between a part and what lies beside it
constexpr float kFacing = 0.8F, kAlike = 0.94F;

struct Sums {
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  float flat = 0.0F;
  float axis_x = 1.0F, axis_y = 0.0F;
  float low = 1e9F, high = -1e9F, low_across = 1e9F, high_across = -1e9F;
};

void look_across(const SegmentGrid& grid, std::size_t i, std::ptrdiff_t step, float slope, float noise, bool inside,
                 int* border, PartMeasure& part) {
  const int label = grid.label[i];
  std::size_t j = i;
  float expected = grid.w[i];
  for (int k = 0; k < kLookAcross && inside; ++k) {
    j += static_cast<std::size_t>(step);
    expected += slope;
    if (grid.label[j] == label) return;
    if (grid.w[j] <= 0.0F || grid.label[j] == kNoPart) continue;
    const float nearer = grid.w[j] - expected, clear = noise + 0.02F * grid.w[i];
    ++(nearer > clear ? part.covered : nearer < -clear ? part.own : part.touching);
    return;
  }
  ++(inside ? part.open : *border);
}

}  // namespace

void measure_parts(int num_parts, const SegmentOptions& options, const SegmentGrid& grid,
                   std::vector<PartMeasure>& measures) {
  measures.assign(static_cast<std::size_t>(num_parts), {});
  std::vector<Sums> sums(measures.size());
  for (std::size_t i = 0; i < grid.label.size(); ++i) {
    if (grid.label[i] < kFirstPart) continue;
    const auto id = static_cast<std::size_t>(grid.label[i] - kFirstPart);
    PartMeasure& part = measures[id];
    Sums& sum = sums[id];
    const float area = grid.area_m2(static_cast<int>(i));
    if (part.cells == 0) part.bottom_m = part.top_m = grid.z[i];
    ++part.cells;
    part.area_m2 += area;
    part.bottom_m = std::min(part.bottom_m, grid.z[i]);
    part.top_m = std::max(part.top_m, grid.z[i]);
    (grid.normal_z[i] > kFacing ? part.up : grid.normal_z[i] < -kFacing ? part.down : part.upright) += area;
    sum.normal += area * Eigen::Vector3f(grid.normal_x[i], grid.normal_y[i], grid.normal_z[i]);
    sum.x += grid.x[i];
    sum.y += grid.y[i];
    sum.xx += grid.x[i] * grid.x[i];
    sum.xy += grid.x[i] * grid.y[i];
    sum.yy += grid.y[i] * grid.y[i];
  }
  for (std::size_t id = 0; id < measures.size(); ++id) {
    Sums& sum = sums[id];
    const double n = std::max(1, measures[id].cells);
    const double xx = sum.xx / n - sum.x * sum.x / (n * n), yy = sum.yy / n - sum.y * sum.y / (n * n),
                 xy = sum.xy / n - sum.x * sum.y / (n * n);
    const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
    sum.axis_x = static_cast<float>(std::cos(angle));
    sum.axis_y = static_cast<float>(std::sin(angle));
    sum.normal.normalize();
  }
  const float noise = static_cast<float>(options.jump_sigmas) * smooth_sigma(options, grid);
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const auto i = static_cast<std::size_t>(grid.index(x, y));
      if (grid.label[i] < kFirstPart) continue;
      const auto id = static_cast<std::size_t>(grid.label[i] - kFirstPart);
      PartMeasure& part = measures[id];
      Sums& sum = sums[id];
      const float along = sum.axis_x * grid.x[i] + sum.axis_y * grid.y[i];
      const float across = sum.axis_x * grid.y[i] - sum.axis_y * grid.x[i];
      sum.low = std::min(sum.low, along);
      sum.high = std::max(sum.high, along);
      sum.low_across = std::min(sum.low_across, across);
      sum.high_across = std::max(sum.high_across, across);
      const float like = sum.normal.dot(Eigen::Vector3f(grid.normal_x[i], grid.normal_y[i], grid.normal_z[i]));
      if (like > kAlike) sum.flat += grid.area_m2(static_cast<int>(i));
      const float slope_x = grid.slope_x[i], slope_y = grid.slope_y[i];
      look_across(grid, i, -1, -slope_x, noise, x > 0, &part.border_side, part);
      look_across(grid, i, 1, slope_x, noise, x + 1 < grid.width, &part.border_side, part);
      look_across(grid, i, -grid.stride, -slope_y, noise, y > 0, &part.border_top, part);
      look_across(grid, i, grid.stride, slope_y, noise, y + 1 < grid.height, &part.border_bottom, part);
    }
  }
  for (std::size_t id = 0; id < measures.size(); ++id) {
    PartMeasure& part = measures[id];
    if (part.cells == 0) continue;
    const Sums& sum = sums[id];
    const float whole = std::max(part.area_m2, 1e-6F);
    part.up /= whole;
    part.down /= whole;
    part.upright /= whole;
    part.flatness = sum.flat / whole;
    part.length_m = sum.high - sum.low;
    part.width_m = sum.high_across - sum.low_across;
  }
}

}  // namespace povslam
