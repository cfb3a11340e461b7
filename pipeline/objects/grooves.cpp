#include "pipeline/objects/grooves.hpp"

#include <cmath>

namespace povslam {
namespace {

constexpr int kRows = 12;                       // above and below, that are averaged
constexpr int kInner = 1, kNear = 3, kFar = 7;  // columns: the groove's, and from … to of either side
constexpr double kSigmas = 3.0;
constexpr double kShallowest_m = 0.005;
constexpr double kFilled = 0.6;  // of each window
constexpr int kEnd = 6;          // rows without evidence that a groove may pass…
constexpr int kLong = 8;         // …and, one at least so long, go on beyond its ends

}  // namespace

void GrooveFinder::Row::add(const Row& other, double sign) {
  behind += sign * other.behind;
  variance += sign * other.variance;
  inverse_depth += sign * other.inverse_depth;
  rows += sign * other.rows;
}

// Within one row alone the three windows show the same surfaces: of several rows together one might show more of a top.
void GrooveFinder::measure_row(const ImageU16& value, const ImageF& depth_m, int y, std::vector<Row>& out) {
  depth_sum_.assign(static_cast<std::size_t>(width_) + 1, 0.0);
  count_.assign(depth_sum_.size(), 0);
  for (int x = 0; x < width_; ++x) {
    const auto at = static_cast<std::size_t>(x);
    const float z = depth_m.at(x, y);
    const bool filled = value.at(x, y) != 0 && z > 0.0F;
    depth_sum_[at + 1] = depth_sum_[at] + (filled ? 1.0 / static_cast<double>(z) : 0.0);
    count_[at + 1] = count_[at] + (filled ? 1 : 0);
  }
  struct Window {
    double mean = 0.0, count = 0.0;
  };
  const auto window = [&](int from, int to) {
    const auto first = static_cast<std::size_t>(from), last = static_cast<std::size_t>(to + 1);
    const double count = count_[last] - count_[first];
    return count < kFilled * (to - from + 1) ? Window{} : Window{(depth_sum_[last] - depth_sum_[first]) / count, count};
  };
  out.assign(static_cast<std::size_t>(width_), Row{});
  for (int x = kFar; x < width_ - kFar; ++x) {
    const std::uint16_t here = value.at(x, y);
    if (here == 0 || value.at(x - kFar, y) != here || value.at(x + kFar, y) != here) continue;
    const Window left = window(x - kFar, x - kNear), right = window(x + kNear, x + kFar),
                 inner = window(x - kInner, x + kInner);
    if (left.count == 0.0 || right.count == 0.0 || inner.count == 0.0) continue;
    out[static_cast<std::size_t>(x)] = {0.5 * (left.mean + right.mean) - inner.mean,
                                        1.0 / inner.count + 0.25 / left.count + 0.25 / right.count, inner.mean, 1.0};
  }
}

bool GrooveFinder::is_groove(const Row& sum) const {
  if (sum.rows < kFilled * (2 * kRows + 1)) return false;
  const double behind = sum.behind / sum.rows, inverse_depth = sum.inverse_depth / sum.rows;
  const double noise = sigma_ * std::sqrt(sum.variance) / sum.rows;
  return behind > kSigmas * noise && behind > kShallowest_m * inverse_depth * inverse_depth;
}

void GrooveFinder::find(const ImageU16& value, const DepthView& view, ImageU8& groove) {
  constexpr int kRing = 2 * kRows + 1;
  width_ = value.width(), height_ = value.height();
  groove.resize(width_, height_);
  groove.fill(0);
  rows_.resize(kRing);
  for (std::vector<Row>& row : rows_) row.assign(static_cast<std::size_t>(width_), Row{});
  sums_.assign(static_cast<std::size_t>(width_), Row{});
  for (int y = -kRows; y < height_; ++y) {
    const int entering = y + kRows;
    std::vector<Row>& row = rows_[static_cast<std::size_t>(entering % kRing)];
    for (std::size_t x = 0; x < row.size(); ++x) sums_[x].add(row[x], -1.0);
    if (entering < height_) {
      measure_row(value, view.depth_m, entering, row);
    } else {
      row.assign(row.size(), Row{});
    }
    for (std::size_t x = 0; x < row.size(); ++x) sums_[x].add(row[x], 1.0);
    for (int x = 0; y >= 0 && x < width_; ++x) {
      if (value.at(x, y) != 0 && is_groove(sums_[static_cast<std::size_t>(x)])) groove.at(x, y) = 1;
    }
  }
  for (int x = 0; x < width_; ++x) close_rows(value, x, groove);
}

// A groove goes on through rows where noise hid it, and one of some length to the end of its thing, where the windows
// ran out of it.
void GrooveFinder::close_rows(const ImageU16& value, int x, ImageU8& groove) const {
  const auto carry_on = [&](int from, int step) {
    for (int y = from, k = 0; k <= kEnd && y >= 0 && y < height_ && value.at(x, y) == value.at(x, from); y += step) {
      groove.at(x, y) = 1;
      ++k;
    }
  };
  int first = -1, last = -height_;
  const auto end = [&] {
    if (first < 0 || last - first < kLong) return;
    carry_on(first, -1);
    carry_on(last, 1);
  };
  for (int y = 0; y < height_; ++y) {
    if (groove.at(x, y) == 0) continue;
    if (y - last > kEnd + 1) {
      end();
      first = y;
    }
    for (int k = std::max(first, last + 1); k < y; ++k) groove.at(x, k) = 1;
    last = y;
  }
  end();
}

}  // namespace povslam
