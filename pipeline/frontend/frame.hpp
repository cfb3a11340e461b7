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
  // Moves features from where their row saw them to where the middle row's instant would have (rolling shutter).
  // twist: the camera's motion in its own axes, (m/s, rad/s). Depth-less features are taken at median_inverse_depth.
  void compensate_motion(const PinholeCamera& camera, const Vector6d& twist, double readout_s);

  TimeNs stamp = 0;
  std::int64_t index = 0;  // counts frames the tracker was given
  OrbFeatures features;
  std::vector<float> x_seen, y_seen;       // px, rectified, as the row saw it
  std::vector<float> x, y;                 // px, rectified, at the instant of the middle row
  std::vector<float> inverse_depth;        // 1/m, 0 = none
  std::vector<float> sigma_inverse_depth;  // 1/m
  std::vector<float> slope_x, slope_y;     // 1/m per px: how inverse depth changes across the image there
  std::vector<float> sigma_px;             // of x, y
  std::vector<std::int32_t> landmark;      // slot in the map of what fits, kNone
  std::vector<std::int32_t> misfit;        // slot of what was looked for here, looks like it and does not fit, kNone
  FeatureGrid grid;
  Rigid3 T_camera_world;
};

// Makes frames: grey image, features, rectification and depth. Owns the buffers; allocation-free after construction.
class FrameBuilder {
 public:
  FrameBuilder(const PinholeCamera& camera, const FrontendOptions& options);
  // wishes: where features are wanted more than elsewhere.
  void build(const RgbdFrame& input, double depth_noise_factor, Frame& frame, std::span<const FeatureWish> wishes = {});
  float level_scale(int level) const { return scales_[static_cast<std::size_t>(level)]; }
  const std::vector<float>& level_scales() const { return scales_; }
  const OrbExtractor& images() const { return extractor_; }
  const PyramidLevel& level(int index) const { return extractor_.level(index); }  // of the last frame built
  // Puts a feature where it was found to lie: raw level-0 px, with its standard deviation.
  void place(Frame& frame, int feature, float x_raw, float y_raw, float sigma_px) const;

 private:
  struct Surface {
    float inverse_depth = 0.0F;            // 1/m, 0 = none
    float sigma = 1.0F;                    // 1/m
    float slope_x = 0.0F, slope_y = 0.0F;  // 1/m per px
  };
  void rectify(Frame& frame) const;
  void measure_depth(const RgbdFrame& input, double noise_factor, Frame& frame) const;
  Surface measure_surface(const RgbdFrame& input, float x, float y) const;

  PinholeCamera camera_;
  NoiseOptions noise_;
  bool distorted_ = false;
  OrbExtractor extractor_;
  ImageU8 grey_;
  std::vector<float> scales_;
};

}  // namespace povslam
