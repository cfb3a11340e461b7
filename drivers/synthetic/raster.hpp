// Which face each pixel's ray meets first, and how far.
#pragma once

#include <cstdint>
#include <vector>

#include "drivers/synthetic/faces.hpp"
#include "pipeline/frames/image.hpp"

namespace povslam::synthetic {

class Raster {
 public:
  static constexpr std::int32_t kSky = 0, kFloor = 1, kFirstFace = 2;  // hit = kFirstFace + index of the face

  // Row-major, every ray through the middle of its pixel. Buffers are kept between calls.
  void cast(const View& view, const std::vector<ProjectedFace>& faces);

  const Image<float>& inverse_depth() const { return w_; }  // 1/z [1/m]; 0 in the sky
  const Image<std::int32_t>& hit() const { return hit_; }

 private:
  void cast_floor(const Plane& floor, int row);
  void cast_face(const ProjectedFace& face, std::int32_t id, int row);

  Image<float> w_;
  Image<std::int32_t> hit_;
  std::vector<float> column_;  // 0 1 2 … as floats
};

}  // namespace povslam::synthetic
