#include "pipeline/frontend/orb_spread.hpp"

#include <algorithm>
#include <functional>

#include "pipeline/base/expects.hpp"

namespace povslam {
namespace {

constexpr int kPatchPx = 8;
constexpr std::uint8_t kFavoured = 2;  // shares
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
  shares_.assign(cells_.size(), 1);
  best_.resize(cells_.size() * patches_ * patches_ * 2);
  candidates_.resize(best_.size());
  contest_.reserve(kFavoured * cells_.size());
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

bool CornerSpread::holds(int column, int row, const FeatureWish& wish, float scale) const {
  constexpr float kQuarter = 0.25F;
  const float width = static_cast<float>(area_.x1 - area_.x0) / static_cast<float>(cell_columns_);
  const float height = static_cast<float>(area_.y1 - area_.y0) / static_cast<float>(cell_rows_);
  const float x0 = static_cast<float>(area_.x0) + static_cast<float>(column) * width, x1 = x0 + width;
  const float y0 = static_cast<float>(area_.y0) + static_cast<float>(row) * height, y1 = y0 + height;
  const float across = std::min(x1, wish.x1 / scale) - std::max(x0, wish.x0 / scale);
  const float down = std::min(y1, wish.y1 / scale) - std::max(y0, wish.y0 / scale);
  const float x = 0.5F * (wish.x0 + wish.x1) / scale, y = 0.5F * (wish.y0 + wish.y1) / scale;
  return (x >= x0 && x < x1 && y >= y0 && y < y1) ||
         (across > 0.0F && down > 0.0F && across * down >= kQuarter * width * height);
}

void CornerSpread::favour(std::span<const FeatureWish> wishes, float scale) {
  for (int row = 0, c = 0; row < cell_rows_; ++row) {
    for (int column = 0; column < cell_columns_; ++column, ++c) {
      const bool wanted =
          std::ranges::any_of(wishes, [&](const FeatureWish& wish) { return holds(column, row, wish, scale); });
      shares_[static_cast<std::size_t>(c)] = wanted ? kFavoured : std::uint8_t{1};
    }
  }
}

template <class Available>
void CornerSpread::share_out(int budget, Available available) {
  // The level of the water: all cells with that many candidates have as many taken, favoured ones twice that.
  for (;;) {
    int open = 0;
    for (std::size_t c = 0; c < cells_.size(); ++c) open += cells_[c].taken < available(cells_[c]) ? shares_[c] : 0;
    if (open == 0 || open > budget) break;
    const int step = budget / open;
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      const int more = std::clamp(available(cells_[c]) - cells_[c].taken, 0, step * shares_[c]);
      cells_[c].taken += more;
      budget -= more;
    }
  }
  // The rest by score, each cell's share at most: until nothing is left of it.
  const std::size_t per_cell = static_cast<std::size_t>(patches_) * patches_ * 2;
  while (budget > 0) {
    contest_.clear();
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      const int last = std::min(available(cells_[c]), cells_[c].taken + shares_[c]);
      for (int k = cells_[c].taken; k < last; ++k) {
        contest_.push_back(score_key(score_of(candidates_[c * per_cell + k]), static_cast<int>(c)));
      }
    }
    if (contest_.empty()) return;
    if (static_cast<int>(contest_.size()) > budget) {
      std::nth_element(contest_.begin(), contest_.begin() + budget, contest_.end(), std::greater<>());
      contest_.resize(budget);
    }
    for (const std::uint64_t key : contest_) ++cells_[index_of(key)].taken;
    budget -= static_cast<int>(contest_.size());
  }
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
