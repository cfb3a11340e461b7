// The image pyramid the features come from. All levels live in one buffer with one row stride, so pixel offsets (the
// BRIEF pattern) are the same on every level. Level l + 1 is level l shrunk by bilinear interpolation, aligned at
// pixel centres: x_l + 0.5 = (x_{l+1} + 0.5) * scale_factor exactly.
#pragma once

#include <vector>

#include "pipeline/frontend/kernels/kernels.hpp"
#include "pipeline/frontend/orb.hpp"

namespace povslam {

class OrbPyramid {
 public:
  // Levels too small to hold min_edge_px pixels both ways are left out; level 0 always exists.
  OrbPyramid(int width, int height, int num_levels, double scale_factor, int min_edge_px);
  OrbPyramid(const OrbPyramid&) = delete;
  OrbPyramid& operator=(const OrbPyramid&) = delete;

  void build(const FrontendKernels& kernels, const std::uint8_t* grey, std::int64_t grey_stride);
  const std::vector<PyramidLevel>& levels() const { return levels_; }

 private:
  struct RowTaps {
    int upper = 0;   // source row; the other is the next one
    int weight = 0;  // of the other, of 128
  };
  struct Shrink {  // how a level comes from the one above it
    std::vector<ShrinkTaps> columns;
    std::vector<RowTaps> rows;
  };

  std::uint8_t* pixels(int level) { return buffer_.data() + offsets_[level]; }
  void shrink(const FrontendKernels& kernels, int level);
  void fill_border(int level);

  std::vector<PyramidLevel> levels_;
  std::vector<std::size_t> offsets_;
  std::vector<Shrink> shrinks_;
  std::vector<std::uint8_t> buffer_;
  std::vector<std::uint16_t> row_sums_[2];
};

}  // namespace povslam
