// Upright grooves in a surface of one class: where two things stand side by side, closer than the gap between them can
// be looked through, the depth between them lies behind both.
#pragma once

#include <vector>

#include "pipeline/mapping/depth_view.hpp"

namespace povslam {

class GrooveFinder {
 public:
  explicit GrooveFinder(double depth_sigma_quadratic_per_m) : sigma_(depth_sigma_quadratic_per_m) {}

  // value: of each pixel of the view, 0 = nothing; a groove lies between pixels of one value. groove: 1 where one is.
  // A plane has none, however slanted; a fold has none. Noise of independent pixels is averaged along the groove.
  void find(const ImageU16& value, const DepthView& view, ImageU8& groove);

 private:
  struct Sum {
    float inverse_depth = 0.0F;  // 1/m
    float count = 0.0F;
  };
  void sum_columns(const ImageU16& value, const ImageF& depth_m);
  Sum mean(int x, int y, int from, int to) const;  // of columns x + from … x + to, rows about y

  void close_rows(const ImageU16& value, int x, ImageU8& groove) const;

  double sigma_;  // of inverse depth [1/m], one pixel
  int width_ = 0, height_ = 0;
  std::vector<double> depth_sum_;  // summed-area tables, one row and column larger
  std::vector<std::int32_t> count_;
};

}  // namespace povslam
