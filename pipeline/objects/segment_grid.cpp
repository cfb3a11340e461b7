#include "pipeline/objects/segment_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace povslam {

namespace {

constexpr int kGridWidth = 320;  // cells, about: enough for things of some centimetres, and the cost is bounded
constexpr int kWindow = 2;       // cells to each side that are averaged
constexpr float kNearest_m = 0.05F, kFarthest_m = 50.0F;
constexpr int kMaxStep = 8;

int step_for(const PinholeCamera& camera) {
  return std::clamp((camera.width + kGridWidth / 2) / kGridWidth, 1, kMaxStep);
}

// The surface that most pixels of a cell show: the mean of those about the median.
float cell_value(std::array<float, kMaxStep * kMaxStep>& values, int count, float gate) {
  if (count == 0) return 0.0F;
  const auto begin = values.begin(), end = begin + count, middle = begin + count / 2;
  std::nth_element(begin, middle, end);
  const float median = *middle;
  float sum = 0.0F;
  int used = 0;
  for (auto it = begin; it != end; ++it) {
    if (std::abs(*it - median) > gate + 0.01F * median) continue;
    sum += *it;
    ++used;
  }
  return sum / static_cast<float>(used);
}

void reduce(const ImageF& depth, float gate, SegmentGrid& grid) {
  std::array<float, kMaxStep * kMaxStep> values;
  for (int y = 0; y < grid.height; ++y) {
    float* out = grid.raw.data() + grid.index(0, y);
    for (int x = 0; x < grid.width; ++x) {
      int count = 0;
      for (int v = 0; v < grid.step; ++v) {
        const float* row = depth.row(y * grid.step + v) + x * grid.step;
        for (int u = 0; u < grid.step; ++u) {
          if (row[u] > kNearest_m && row[u] < kFarthest_m) values[static_cast<std::size_t>(count++)] = 1.0F / row[u];
        }
      }
      out[x] = cell_value(values, count, gate);
    }
  }
}

// Mean over a window of what lies close to the middle cell. Planes stay planes: the gate cuts on both sides alike.
void smooth(float gate, SegmentGrid& grid) {
  std::vector<float> sum(static_cast<std::size_t>(grid.width)), count(sum.size());
  for (int y = 0; y < grid.height; ++y) {
    const float* center = grid.raw.data() + grid.index(0, y);
    std::fill(sum.begin(), sum.end(), 0.0F);
    std::fill(count.begin(), count.end(), 0.0F);
    for (int v = -kWindow; v <= kWindow; ++v) {
      for (int u = -kWindow; u <= kWindow; ++u) {
        const float* other = center + v * grid.stride + u;
        for (int x = 0; x < grid.width; ++x) {
          const float near = std::abs(other[x] - center[x]) < gate + 0.01F * center[x] ? 1.0F : 0.0F;
          const float there = other[x] > 0.0F ? near : 0.0F;
          sum[static_cast<std::size_t>(x)] += there * other[x];
          count[static_cast<std::size_t>(x)] += there;
        }
      }
    }
    float* out = grid.w.data() + grid.index(0, y);
    for (int x = 0; x < grid.width; ++x) {
      const float n = count[static_cast<std::size_t>(x)];
      out[x] = center[x] > 0.0F ? sum[static_cast<std::size_t>(x)] / std::max(n, 1.0F) : 0.0F;
    }
  }
}

}  // namespace

SegmentGrid::SegmentGrid(const PinholeCamera& camera) {
  EXPECTS(camera.valid());
  step = step_for(camera);
  width = camera.width / step;
  height = camera.height / step;
  stride = width + 2 * kMargin;
  const auto cells = static_cast<float>(step), half = 0.5F * (cells - 1.0F);
  focal_x = static_cast<float>(camera.fx) / cells;
  focal_y = static_cast<float>(camera.fy) / cells;
  center_x = (static_cast<float>(camera.cx) - half) / cells;
  center_y = (static_cast<float>(camera.cy) - half) / cells;
  const std::size_t size = static_cast<std::size_t>(stride) * static_cast<std::size_t>(height + 2 * kMargin);
  for (std::vector<float>* each : {&raw, &w, &slope_x, &slope_y, &x, &y, &z, &normal_x, &normal_y, &normal_z})
    each->assign(size, 0.0F);
  edge.assign(size, 0);
  label.assign(size, kNoPart);
}

float SegmentGrid::area_m2(int i) const {
  const std::size_t c = static_cast<std::size_t>(i);
  // The cell's area seen from the front, over the cosine to the normal; grazing looks count no more than five times.
  const float along = slope_x[c] * focal_x, down = slope_y[c] * focal_y;
  const float tilt = std::sqrt(along * along + down * down) / std::max(w[c], 1e-3F);
  return std::min(5.0F, std::sqrt(1.0F + tilt * tilt)) / (focal_x * focal_y * w[c] * w[c]);
}

void take_depth(const DepthView& view, const SegmentOptions& options, SegmentGrid& grid) {
  const auto sigma = static_cast<float>(options.depth_sigma_quadratic_per_m);
  constexpr float kGateSigmas = 5.0F;
  reduce(view.depth_m, kGateSigmas * sigma, grid);
  smooth(kGateSigmas * sigma / static_cast<float>(grid.step), grid);
}

}  // namespace povslam
