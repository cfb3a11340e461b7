#include "pipeline/frontend/orb_spread.hpp"

#include <algorithm>
#include <functional>

#include "pipeline/base/expects.hpp"

namespace povslam {
namespace {

constexpr int kPatchPx = 8;
constexpr std::uint32_t kLast = 0xFFFFFFFFU;

// Larger is better: score first, then the earlier in raster order.
std::uint64_t score_key(int score, int index) {
  return static_cast<std::uint64_t>(score) << 32 | (kLast - static_cast<std::uint32_t>(index));
}
int index_of(std::uint64_t key) {
  return static_cast<int>(kLast - static_cast<std::uint32_t>(key));
}
int score_of(std::uint64_t key) {
  return static_cast<int>(key >> 32 & 0xFF);
}

std::vector<std::uint16_t> divide(int length, int parts) {
  std::vector<std::uint16_t> part(length);
  for (int k = 0; k < length; ++k) part[k] = static_cast<std::uint16_t>(static_cast<std::int64_t>(k) * parts / length);
  return part;
}

}  // namespace

CornerSpread::CornerSpread(PixelRect area, int cell_px) : area_(area) {
  const int width = area.x1 - area.x0, height = area.y1 - area.y0;
  EXPECTS(width > 0 && height > 0 && cell_px >= 1);
  cell_columns_ = std::max(1, (width + cell_px / 2) / cell_px);
  cell_rows_ = std::max(1, (height + cell_px / 2) / cell_px);
  patches_ = std::max(1, (cell_px + kPatchPx / 2) / kPatchPx);
  patch_column_ = divide(width, cell_columns_ * patches_);
  patch_row_ = divide(height, cell_rows_ * patches_);
  cells_.resize(static_cast<std::size_t>(cell_columns_) * cell_rows_);
  best_.resize(cells_.size() * patches_ * patches_ * 2);
  candidates_.resize(best_.size());
  contest_.reserve(cells_.size());
  chosen_.resize(best_.size());
}

void CornerSpread::collect(const FastCorner* corners, int count) {
  std::fill(best_.begin(), best_.end(), 0);
  const int pitch = cell_columns_ * patches_;
  for (int k = 0; k < count; ++k) {
    const int patch = patch_row_[corners[k].y - area_.y0] * pitch + patch_column_[corners[k].x - area_.x0];
    std::uint64_t* const best = best_.data() + 2 * static_cast<std::size_t>(patch);
    const std::uint64_t key = score_key(corners[k].score, k);
    best[1] = std::max(best[1], std::min(best[0], key));
    best[0] = std::max(best[0], key);
  }
}

void CornerSpread::rank(const FastCorner* corners, int good_score) {
  const std::size_t per_cell = static_cast<std::size_t>(patches_) * patches_ * 2;
  const std::size_t pitch = static_cast<std::size_t>(cell_columns_) * patches_ * 2;
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    Cell& cell = cells_[c];
    cell = Cell{};
    std::uint64_t* const out = candidates_.data() + c * per_cell;
    const std::uint64_t* in = best_.data() + c / cell_columns_ * patches_ * pitch + c % cell_columns_ * patches_ * 2;
    for (int row = 0; row < patches_; ++row, in += pitch) {
      for (int k = 0; k < 2 * patches_; ++k) {
        if (in[k] == 0) continue;
        const bool good = corners[index_of(in[k])].score >= good_score;
        const std::uint64_t preference = (good ? 2U : 0U) + (k % 2 == 0 ? 1U : 0U);
        out[cell.all++] = preference << 40 | in[k];
        cell.good += good ? 1 : 0;
      }
    }
    std::sort(out, out + cell.all, std::greater<>());
  }
}

template <class Available>
void CornerSpread::share_out(int budget, Available available) {
  // The level of the water: all cells with that many candidates have as many taken.
  for (;;) {
    int open = 0;
    for (const Cell& cell : cells_) open += cell.taken < available(cell) ? 1 : 0;
    if (open == 0 || open > budget) break;
    const int step = budget / open;
    for (Cell& cell : cells_) {
      const int more = std::clamp(available(cell) - cell.taken, 0, step);
      cell.taken += more;
      budget -= more;
    }
  }
  if (budget == 0) return;
  contest_.clear();
  const std::size_t per_cell = static_cast<std::size_t>(patches_) * patches_ * 2;
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    if (cells_[c].taken >= available(cells_[c])) continue;
    contest_.push_back(score_key(score_of(candidates_[c * per_cell + cells_[c].taken]), static_cast<int>(c)));
  }
  if (static_cast<int>(contest_.size()) > budget) {
    std::nth_element(contest_.begin(), contest_.begin() + budget, contest_.end(), std::greater<>());
    contest_.resize(budget);
  }
  for (const std::uint64_t key : contest_) ++cells_[index_of(key)].taken;
}

int CornerSpread::choose(FastCorner* corners, int count, int wanted, int good_score) {
  collect(corners, count);
  rank(corners, good_score);
  const int poor_share = std::max(1, wanted / (2 * static_cast<int>(cells_.size())));
  share_out(wanted, [&](const Cell& cell) { return cell.good > 0 ? cell.good : std::min(cell.all, poor_share); });
  const std::size_t per_cell = static_cast<std::size_t>(patches_) * patches_ * 2;
  int total = 0;
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    for (int k = 0; k < cells_[c].taken; ++k) chosen_[total++] = corners[index_of(candidates_[c * per_cell + k])];
  }
  std::copy_n(chosen_.begin(), total, corners);
  return total;
}

}  // namespace povslam
