// How noisy this camera really is, learned while tracking: factors on the noise model from the residuals of matched
// landmarks. A sensor whose depth is poorly registered or whose lens is poorly known thereby loses weight by itself.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace povslam {

class NoiseScale {
 public:
  explicit NoiseScale(std::size_t capacity) { samples_.reserve(capacity); }

  double value() const { return value_; }

  // One frame's whitened residual norms (under the model without the factor). expected_quartile: the value three
  // quarters of them stay below when the model is right. Real errors have heavier tails than the model: the upper
  // quartile sees them, the median would not.
  void start() { samples_.clear(); }
  void add(double whitened) {
    if (samples_.size() < samples_.capacity()) samples_.push_back(whitened);
  }
  void finish(double expected_quartile) {
    constexpr std::size_t kEnough = 40;
    constexpr double kShare = 0.1;  // of the newest frame: settles within some twenty frames
    if (samples_.size() < kEnough) return;
    const auto quartile = samples_.begin() + static_cast<std::ptrdiff_t>(samples_.size() * 3 / 4);
    std::nth_element(samples_.begin(), quartile, samples_.end());
    const double seen = std::clamp(*quartile / expected_quartile, kLeast, kMost);
    value_ = std::exp((1.0 - kShare) * std::log(value_) + kShare * std::log(seen));
  }

 private:
  static constexpr double kLeast = 0.5, kMost = 8.0;
  std::vector<double> samples_;
  double value_ = 1.0;
};

}  // namespace povslam
