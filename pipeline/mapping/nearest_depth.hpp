// The least depth measured in any box of pixels, quickly: a pyramid of minima.
#pragma once

#include <vector>

#include "pipeline/mapping/depth_view.hpp"
#include "pipeline/mapping/visible_blocks.hpp"

namespace povslam {

class NearestDepth {
 public:
  static constexpr float kNothing_m = 1e9F;  // not measured

  explicit NearestDepth(const ImageF& depth_m);
  // Of the box and some pixels around it (never too far). The box is not empty and lies in the image.
  float within(const PixelBox& box) const;

 private:
  std::vector<ImageF> levels_;  // level k: tiles of 4 << k pixels
};

}  // namespace povslam
