#include "pipeline/objects/segment_boards.hpp"

#include <algorithm>
#include <cmath>

namespace povslam {

namespace {

constexpr float kBin_m = 0.04F;
constexpr int kMaxBins = 100;
constexpr int kBridged = 1;  // columns that may be missing in a run: noise, not a gap between things

}  // namespace

float BoardFinder::Run::length() const {
  return std::hypot(end_x - start_x, end_y - start_y);
}

bool BoardFinder::mark(int num_parts, const SegmentOptions& options, SegmentGrid& grid) {
  cells_.resize(std::max(cells_.size(), static_cast<std::size_t>(num_parts)));
  for (auto& cells : cells_) cells.clear();
  for (std::size_t i = 0; i < grid.label.size(); ++i) {
    if (grid.label[i] >= kFirstPart) cells_[static_cast<std::size_t>(grid.label[i] - kFirstPart)].push_back(i);
  }
  bool found = false;
  for (int part = 0; part < num_parts; ++part)
    found |= mark_part(part + kFirstPart, cells_[static_cast<std::size_t>(part)], options, grid);
  return found;
}

void BoardFinder::find_runs(const std::vector<std::size_t>& cells, const SegmentGrid& grid) {
  const std::size_t columns = static_cast<std::size_t>(grid.width);
  there_.assign(static_cast<std::size_t>(bins_) * columns, 0);
  column_x_.resize(there_.size());
  column_y_.resize(there_.size());
  for (const std::size_t i : cells) {
    const std::size_t column = i % static_cast<std::size_t>(grid.stride) - SegmentGrid::kMargin;
    const int bin = static_cast<int>((grid.z[i] - bottom_) / kBin_m);
    if (bin < 0 || bin >= bins_) continue;
    const std::size_t at = static_cast<std::size_t>(bin) * columns + column;
    there_[at] = 1;
    column_x_[at] = grid.x[i];
    column_y_[at] = grid.y[i];
  }
}

bool BoardFinder::mark_part(int, const std::vector<std::size_t>& cells, const SegmentOptions& options,
                            SegmentGrid& grid) {
  const auto least_length = static_cast<float>(options.board_length_m);
  float low_x = 1e9F, low_y = 1e9F, high_x = -1e9F, high_y = -1e9F, top = -1e9F;
  bottom_ = 1e9F;
  for (const std::size_t i : cells) {
    low_x = std::min(low_x, grid.x[i]);
    high_x = std::max(high_x, grid.x[i]);
    low_y = std::min(low_y, grid.y[i]);
    high_y = std::max(high_y, grid.y[i]);
    bottom_ = std::min(bottom_, grid.z[i]);
    top = std::max(top, grid.z[i]);
  }
  if (std::hypot(high_x - low_x, high_y - low_y) < least_length) return false;
  bins_ = std::min(kMaxBins, static_cast<int>((top - bottom_) / kBin_m) + 1);
  find_runs(cells, grid);
  const std::size_t columns = static_cast<std::size_t>(grid.width);
  std::vector<std::uint8_t> on_run(there_.size(), 0);
  std::vector<float> longest(static_cast<std::size_t>(bins_), 0.0F);
  for (int bin = 0; bin < bins_; ++bin) {
    const std::size_t base = static_cast<std::size_t>(bin) * columns;
    for (std::size_t c = 0; c < columns;) {
      if (there_[base + c] == 0) {
        ++c;
        continue;
      }
      std::size_t last = c;
      while (true) {
        std::size_t next = last + 1;
        while (next < columns && next <= last + 1 + kBridged && there_[base + next] == 0) ++next;
        if (next >= columns || next > last + 1 + kBridged) break;
        last = next;
      }
      const float length =
          std::hypot(column_x_[base + last] - column_x_[base + c], column_y_[base + last] - column_y_[base + c]);
      if (length >= least_length) {
        for (std::size_t k = c; k <= last; ++k) on_run[base + k] = 1;
        longest[static_cast<std::size_t>(bin)] = std::max(longest[static_cast<std::size_t>(bin)], length);
      }
      c = last + 1;
    }
  }
  const int thickest = static_cast<int>(options.board_thickness_m / kBin_m) + 1;
  bool found = false;
  for (int bin = 0; bin < bins_;) {
    if (longest[static_cast<std::size_t>(bin)] < least_length) {
      ++bin;
      continue;
    }
    int end = bin;
    while (end < bins_ && longest[static_cast<std::size_t>(end)] >= least_length) ++end;
    const bool board = end - bin <= thickest;
    for (int b = bin; b < end; ++b) {
      if (!board)
        std::fill_n(on_run.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(b) * columns), columns,
                    std::uint8_t{0});
    }
    found |= board;
    bin = end;
  }
  if (!found) return false;
  for (const std::size_t i : cells) {
    const std::size_t column = i % static_cast<std::size_t>(grid.stride) - SegmentGrid::kMargin;
    const int bin = static_cast<int>((grid.z[i] - bottom_) / kBin_m);
    if (bin < bins_ && on_run[static_cast<std::size_t>(bin) * columns + column] != 0) grid.label[i] = kStructurePart;
  }
  return true;
}

}  // namespace povslam
