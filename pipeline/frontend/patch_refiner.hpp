// Gives matched features the place where their landmark's patch fits best.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/frontend/frame.hpp"
#include "pipeline/frontend/map.hpp"
#include "pipeline/frontend/noise_scale.hpp"
#include "pipeline/geometry/camera.hpp"

namespace povslam {

class PatchRefiner {
 public:
  PatchRefiner(const PinholeCamera& camera, const FrontendOptions& options);

  void start(const Frame& frame);  // no feature is placed yet
  // True when the feature was moved. T_camera_world: a pose near enough to predict the patch's shape.
  bool refine(Map& map, std::int32_t landmark, const FrameBuilder& images, const Rigid3& T_camera_world, Frame& frame,
              int feature);
  bool placed(int feature) const { return level_scale_[static_cast<std::size_t>(feature)] > 0.0F; }

  double sigma_px() const { return sigma_px_ * noise_.value(); }  // of a placed feature, on level 0

  // Residuals of placed features teach how well patches fit on this camera: start, learn each, finish.
  void start_learning() { noise_.start(); }
  void learn(int feature, double residual_px);
  void finish_learning() { noise_.finish(1.6651); }  // of the length of a two-dimensional standard normal

 private:
  PinholeCamera camera_;
  double sigma_px_;
  double log_scale_;
  NoiseScale noise_;
  std::vector<float> level_scale_;  // of the level a feature was placed on; 0 = as detected
};

}  // namespace povslam
