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
  struct Row {              // at a pixel, of its row alone, or summed over rows
    double behind = 0.0;    // 1/m: how far the middle lies behind both sides
    double variance = 0.0;  // of that, in units of one pixel's
    double inverse_depth = 0.0;
    double rows = 0.0;

    void add(const Row& other, double sign);
  };
  void measure_row(const ImageU16& value, const ImageF& depth_m, int y, std::vector<Row>& out);
  bool is_groove(const Row& sum) const;
  void close_rows(const ImageU16& value, int x, ImageU8& groove) const;

  double sigma_;  // of inverse depth [1/m], one pixel
  int width_ = 0, height_ = 0;
  std::vector<double> depth_sum_;  // of inverse depth, along a row
  std::vector<std::int32_t> count_;
  std::vector<std::vector<Row>> rows_;  // the latest, a ring
  std::vector<Row> sums_;               // over those, by column
};

}  // namespace povslam
