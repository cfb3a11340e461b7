#include "pipeline/objects/segment_boards.hpp"

#include <algorithm>
#include <cmath>

namespace povslam {

namespace {

constexpr float kBin_m = 0.04F;
constexpr int kMaxBins = 100;
constexpr std::size_t kBridged = 1;  // columns that may be missing in a run: noise, not a gap between things
constexpr float kShorter = 0.7F;     // what is right above and below a board is this much shorter
constexpr float kLongerOnFloor = 1.5F;
constexpr float kKnownLength = 0.35F;  // of board_length_m, at the height of a board already found

std::size_t to_size(int value) {
  return static_cast<std::size_t>(value);
}

}  // namespace

bool BoardFinder::mark(int num_parts, float floor_height_m, const SegmentOptions& options, SegmentGrid& grid) {
  collect(num_parts, grid);
  boards_.clear();
  places_.clear();
  const auto length = static_cast<float>(options.board_length_m);
  const float near_floor_m = floor_height_m + static_cast<float>(options.board_thickness_m);
  bool found = false;
  for (const Part& part : parts_) {
    if (part.extent_m < length) continue;
    find_runs(part, length, grid);
    choose_free(near_floor_m, options);
    found |= label_chosen(part, grid);
  }
  // Close to the floor, pallets and boxes have their feet at that height too.
  std::erase_if(boards_, [&](const Band& board) { return board.low < near_floor_m; });
  if (boards_.empty()) return found;
  for (const Part& part : parts_) {
    if (part.extent_m < kKnownLength * length) continue;
    find_runs(part, kKnownLength * length, grid);
    choose_at_known_heights(part, options);
    found |= label_chosen(part, grid);
  }
  return found;
}

void BoardFinder::collect(int num_parts, const SegmentGrid& grid) {
  columns_ = to_size(grid.width);
  parts_.resize(to_size(num_parts));
  for (Part& part : parts_) part.cells.clear();
  for (std::size_t i = 0; i < grid.label.size(); ++i) {
    if (grid.label[i] >= kFirstPart) parts_[to_size(grid.label[i] - kFirstPart)].cells.push_back(i);
  }
  for (Part& part : parts_) {
    const std::size_t any = part.cells.front();
    float low_x = grid.x[any], high_x = low_x, low_y = grid.y[any], high_y = low_y;
    part.bottom = part.top = grid.z[any];
    for (const std::size_t i : part.cells) {
      low_x = std::min(low_x, grid.x[i]);
      high_x = std::max(high_x, grid.x[i]);
      low_y = std::min(low_y, grid.y[i]);
      high_y = std::max(high_y, grid.y[i]);
      part.bottom = std::min(part.bottom, grid.z[i]);
      part.top = std::max(part.top, grid.z[i]);
    }
    part.extent_m = std::hypot(high_x - low_x, high_y - low_y);
  }
}

float BoardFinder::run_length(int bin, std::size_t first, std::size_t last) const {
  const std::size_t a = to_size(bin) * columns_ + first, b = to_size(bin) * columns_ + last;
  return std::hypot(column_x_[b] - column_x_[a], column_y_[b] - column_y_[a]);
}

// Columns of an image are upright enough, and a run across them is what the eye would call level and unbroken.
void BoardFinder::find_runs(const Part& part, float least_m, const SegmentGrid& grid) {
  bottom_ = part.bottom;
  bins_ = std::min(kMaxBins, static_cast<int>((part.top - part.bottom) / kBin_m) + 1);
  there_.assign(to_size(bins_) * columns_, 0);
  on_run_.assign(there_.size(), 0);
  column_x_.resize(there_.size());
  column_y_.resize(there_.size());
  longest_m_.assign(to_size(bins_), 0.0F);
  chosen_.assign(to_size(bins_), 0);
  for (const std::size_t i : part.cells) {
    const int bin = static_cast<int>((grid.z[i] - bottom_) / kBin_m);
    if (bin >= bins_ || grid.label[i] == kStructurePart) continue;
    const std::size_t at = to_size(bin) * columns_ + i % to_size(grid.stride) - SegmentGrid::kMargin;
    there_[at] = 1;
    column_x_[at] = grid.x[i];
    column_y_[at] = grid.y[i];
  }
  for (int bin = 0; bin < bins_; ++bin) {
    const std::uint8_t* there = there_.data() + to_size(bin) * columns_;
    for (std::size_t first = 0; first < columns_; ++first) {
      if (there[first] == 0) continue;
      std::size_t last = first;
      for (std::size_t c = first + 1; c < columns_ && c <= last + 1 + kBridged; ++c) last = there[c] != 0 ? c : last;
      const float length = run_length(bin, first, last);
      if (length >= least_m) std::fill_n(on_run_.data() + to_size(bin) * columns_ + first, last - first + 1, 1);
      longest_m_[to_size(bin)] = std::max(longest_m_[to_size(bin)], length);
      first = last;
    }
  }
}

void BoardFinder::choose_free(float near_floor_m, const SegmentOptions& options) {
  const auto least = static_cast<float>(options.board_length_m);
  const int thickest = static_cast<int>(static_cast<float>(options.board_thickness_m) / kBin_m) + 1;
  for (int bin = 0; bin < bins_;) {
    int end = bin;
    float length = 0.0F, beside = 0.0F;
    for (; end < bins_ && longest_m_[to_size(end)] >= least; ++end) length = std::max(length, longest_m_[to_size(end)]);
    for (const int b : {bin - 2, bin - 1, end, end + 1}) {
      if (b >= 0 && b < bins_) beside = std::max(beside, longest_m_[to_size(b)]);
    }
    const float low = bottom_ + kBin_m * static_cast<float>(bin);
    const bool long_enough = length >= (low < near_floor_m ? kLongerOnFloor : 1.0F) * least;
    if (end > bin && end - bin <= thickest && long_enough && beside < kShorter * length) {
      std::fill(chosen_.begin() + bin, chosen_.begin() + end, std::uint8_t{1});
      boards_.push_back({low, bottom_ + kBin_m * static_cast<float>(end)});
    }
    bin = std::max(end, bin + 1);
  }
}

void BoardFinder::choose_at_known_heights(const Part& part, const SegmentOptions& options) {
  const auto thickness = static_cast<float>(options.board_thickness_m);
  for (const Band& board : boards_) {
    if (board.low - kBin_m > part.bottom || part.bottom > board.high || board.high - part.bottom > thickness) continue;
    const int end = std::min(bins_, static_cast<int>((board.high - bottom_) / kBin_m + 0.5F));
    for (int bin = 0; bin < end; ++bin) chosen_[to_size(bin)] = 1;
  }
}

bool BoardFinder::label_chosen(const Part& part, SegmentGrid& grid) {
  bool found = false;
  for (const std::size_t i : part.cells) {
    const int bin = static_cast<int>((grid.z[i] - bottom_) / kBin_m);
    if (bin >= bins_ || chosen_[to_size(bin)] == 0) continue;
    const std::size_t column = i % to_size(grid.stride) - SegmentGrid::kMargin;
    if (on_run_[to_size(bin) * columns_ + column] == 0) continue;
    grid.label[i] = kStructurePart;
    places_.emplace_back(grid.x[i], grid.y[i], grid.z[i]);
    found = true;
  }
  return found;
}

}  // namespace povslam
