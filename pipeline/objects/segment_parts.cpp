#include "pipeline/objects/segment_parts.hpp"

#include <algorithm>
#include <cmath>

namespace povslam {

namespace {

constexpr int kGrowth = 5;  // cells

// How far apart two neighbours are beside what the surface's own slope makes.
inline float gap(const SegmentGrid& grid, std::size_t i, std::size_t j, float slope) {
  return std::abs(grid.w[j] - grid.w[i] - slope);
}

}  // namespace

int PartFinder::root(int label) {
  while (parent_[static_cast<std::size_t>(label)] != label) {
    int& up = parent_[static_cast<std::size_t>(label)];
    up = parent_[static_cast<std::size_t>(up)];
    label = up;
  }
  return label;
}

int PartFinder::find(const SegmentOptions& options, int min_cells, SegmentGrid& grid) {
  const float noise = static_cast<float>(options.jump_sigmas) * smooth_sigma(options, grid);
  const auto share = static_cast<float>(options.jump_share);
  parent_.assign({0, 1});
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const auto i = static_cast<std::size_t>(grid.index(x, y));
      int& label = grid.label[i];
      if (label == kStructurePart) continue;
      label = kNoPart;
      if (grid.w[i] <= 0.0F || grid.edge[i] != 0) continue;
      const float far = noise + share * grid.w[i];
      const std::size_t left = i - 1, up = i - static_cast<std::size_t>(grid.stride);
      if (grid.label[left] >= kFirstPart && gap(grid, i, left, -grid.slope_x[i]) < far) label = root(grid.label[left]);
      if (grid.label[up] >= kFirstPart && gap(grid, i, up, -grid.slope_y[i]) < far) {
        const int other = root(grid.label[up]);
        if (label == kNoPart) label = other;
        const int least = std::min(label, other);
        parent_[static_cast<std::size_t>(label)] = parent_[static_cast<std::size_t>(other)] = least;
        label = least;
      }
      if (label != kNoPart) continue;
      label = static_cast<int>(parent_.size());
      parent_.push_back(label);
    }
  }
  cells_.assign(parent_.size(), 0);
  for (int& label : grid.label) {
    if (label < kFirstPart) continue;
    label = root(label);
    ++cells_[static_cast<std::size_t>(label)];
  }
  int next = kFirstPart;
  renamed_.assign(parent_.size(), kNoPart);
  renamed_[kStructurePart] = kStructurePart;
  for (std::size_t i = kFirstPart; i < parent_.size(); ++i) {
    if (cells_[i] >= min_cells) renamed_[i] = next++;
  }
  for (int& label : grid.label) label = renamed_[static_cast<std::size_t>(label)];
  return next - kFirstPart;
}

void grow_parts(const SegmentOptions& options, SegmentGrid& grid) {
  const float noise = static_cast<float>(options.jump_sigmas) * smooth_sigma(options, grid);
  std::vector<std::size_t> open, still_open;
  std::vector<std::pair<std::size_t, int>> joined;
  for (std::size_t i = 0; i < grid.w.size(); ++i) {
    if (grid.w[i] > 0.0F && grid.label[i] == kNoPart) open.push_back(i);
  }
  const std::ptrdiff_t beside[] = {-1, 1, -grid.stride, grid.stride};
  for (int round = 0; round < kGrowth && !open.empty(); ++round) {
    joined.clear();
    still_open.clear();
    for (const std::size_t i : open) {
      float least = noise + 0.02F * grid.w[i];
      int label = kNoPart;
      for (const std::ptrdiff_t step : beside) {
        const std::size_t j = i + static_cast<std::size_t>(step);
        if (grid.label[j] == kNoPart) continue;
        const float apart = std::abs(grid.w[j] - grid.w[i]);
        if (apart < least) {
          least = apart;
          label = grid.label[j];
        }
      }
      if (label == kNoPart) {
        still_open.push_back(i);
      } else {
        joined.emplace_back(i, label);
      }
    }
    for (const auto& [i, label] : joined) grid.label[i] = label;
    open.swap(still_open);
  }
}

}  // namespace povslam
