// Warps the depth image of a camera of its own into the colour camera: what an RGB-D sensor's registration does.
//
// Each depth pixel becomes a point, is moved into the colour frame and covers the colour pixels its own footprint
// covers there (its angular size scaled to colour pixels), the nearest point winning. On any surface seen by both
// cameras this leaves no pinholes; colour pixels that the depth camera does not see stay 0.
#pragma once

#include <vector>

#include "drivers/replay/camera_file.hpp"
#include "pipeline/frames/image.hpp"

namespace povslam {

class DepthRegistration {
 public:
  DepthRegistration(const DepthCamera& depth, const PinholeCamera& color, double depth_scale);

  // depth: in the depth camera, of its size. registered: resized to the colour camera. Warm, it allocates nothing.
  void warp(const ImageU16& depth, ImageU16& registered) const;

 private:
  // Writes depth z_color to the pixels under one depth pixel; plane: where it is seen, after the lens, on z = 1;
  // scale: its footprint against that at equal distance.
  void cover(const Eigen::Vector2f& plane, float z_color, float scale, ImageU16& registered) const;

  PinholeCamera color_;
  int width_ = 0, height_ = 0;               // of the depth image, px
  std::vector<Eigen::Vector3f> rays_color_;  // per depth pixel: what one unit of depth moves it in the colour frame
  Eigen::Vector3f translation_;              // T_color_depth's, in depth units
  float half_x_ = 0.0F, half_y_ = 0.0F;      // half the footprint of a depth pixel at equal distance, colour px
};

}  // namespace povslam
