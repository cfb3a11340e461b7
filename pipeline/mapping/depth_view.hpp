// One RGB-D frame as the dense map and the segmentation see it: rectified, in metres, each pixel with its owner.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/base/time.hpp"
#include "pipeline/frames/image.hpp"
#include "pipeline/frames/label_frame.hpp"
#include "pipeline/frames/rgbd_frame.hpp"
#include "pipeline/geometry/camera.hpp"
#include "pipeline/geometry/rigid.hpp"

namespace povslam {

using ImageF = Image<float>;

// Whose surface a pixel shows, within one view.
inline constexpr std::uint16_t kNobody = 0;         // not known, or too near an edge to be told
inline constexpr std::uint16_t kStructure = 1;      // floor, walls, racks
inline constexpr std::uint16_t kMoving = 2;         // of a class that moves while one looks: in no map
inline constexpr std::uint16_t kFirstInstance = 3;  // and up: one thing each, numbered anew in each view

struct DepthView {
  TimeNs stamp = 0;
  PinholeCamera camera;                         // without distortion
  ImageF depth_m;                               // along the optical axis; 0 = no measurement, or outside the range
  double min_depth_m = 0.3, max_depth_m = 5.0;  // the range
  ImageU8 color;                                // 1 channel grey or 3 channels R, G, B; empty: none
  ImageU16 owner;                               // one of these
  Rigid3 T_world_camera;                        // of this frame
};

struct DepthNoise {  // sigma_z = quadratic z^2, and the floor in quadrature
  double quadratic_per_m = 0.0025;
  double floor_m = 0.003;
};

struct DepthViewOptions {
  double min_depth_m = 0.3;
  double max_depth_m = 8.0;
};

// Rectifies by nearest pixel (depths of two surfaces must not be mixed). Tables are made once.
class DepthViewBuilder {
 public:
  DepthViewBuilder(const PinholeCamera& camera, const DepthViewOptions& options);
  // owner: all kNobody. The depth image has the camera's size; a colour image that has not is left out.
  void build(const RgbdFrame& frame, const Rigid3& T_world_camera, DepthView& view) const;
  // Classes of the view's pixels, from labels of the raw image that may be smaller (nearest).
  void rectify_labels(const LabelFrame& labels, ImageU8& classes) const;

 private:
  PinholeCamera camera_;
  DepthViewOptions options_;
  std::vector<std::int32_t> source_;  // raw pixel of each rectified one, -1: outside; empty: no distortion
};

}  // namespace povslam
