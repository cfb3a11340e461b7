// One image as the tracker sees it: features with rectified position and inverse depth, and the landmark each one saw.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/base/time.hpp"
#include "pipeline/frames/rgbd_frame.hpp"
#include "pipeline/frontend/feature_grid.hpp"
#include "pipeline/frontend/options.hpp"
#include "pipeline/frontend/orb.hpp"
#include "pipeline/geometry/camera.hpp"
#include "pipeline/geometry/rigid.hpp"

namespace povslam {

inline constexpr std::int32_t kNone = -1;  // no landmark, no keyframe

struct Frame {
  Frame(const PinholeCamera& camera, const FrontendOptions& options);

  int size() const { return features.size; }
  bool has_depth(int i) const { return inverse_depth[static_cast<std::size_t>(i)] > 0.0F; }
  Eigen::Vector3d point_camera(int i, const PinholeCamera& camera) const;  // of a feature with depth

  TimeNs stamp = 0;
  std::int64_t index = 0;  // counts frames the tracker was given
  OrbFeatures features;
  std::vector<float> x, y;                 // px, rectified
  std::vector<float> inverse_depth;        // 1/m, 0 = none
  std::vector<float> sigma_inverse_depth;  // 1/m
  std::vector<std::int32_t> landmark;      // slot in the map, kNone
  FeatureGrid grid;
  Rigid3 T_camera_world;
};

// Makes frames: grey image, features, rectification and depth. Owns the buffers; allocation-free after construction.
class FrameBuilder {
 public:
  FrameBuilder(const PinholeCamera& camera, const FrontendOptions& options);
  void build(const RgbdFrame& input, Frame& frame);
  float level_scale(int level) const { return scales_[static_cast<std::size_t>(level)]; }
  const std::vector<float>& level_scales() const { return scales_; }

 private:
  void rectify(Frame& frame) const;
  void measure_depth(const RgbdFrame& input, Frame& frame) const;

  PinholeCamera camera_;
  NoiseOptions noise_;
  OrbExtractor extractor_;
  ImageU8 grey_;
  std::vector<float> scales_;
};

}  // namespace povslam
