#include "pipeline/frontend/patch_refiner.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace povslam {

namespace {
constexpr float kMaxShiftPx = 2.5F;  // of the level searched: how far a detector may have been off
constexpr float kMinCorrelation = 0.8F;
constexpr double kSmallest = 0.4;  // px of level 0 a patch pixel must cover, or it is seen too small to fit
}  // namespace

PatchRefiner::PatchRefiner(const PinholeCamera& camera, const FrontendOptions& options)
    : camera_(camera),
      sigma_px_(options.noise.patch_sigma_px),
      log_scale_(std::log(options.orb.scale_factor)),
      noise_(static_cast<std::size_t>(options.orb.num_features)),
      level_scale_(static_cast<std::size_t>(options.orb.num_features), 0.0F) {}

void PatchRefiner::start(const Frame& frame) {
  std::fill_n(level_scale_.begin(), frame.size(), 0.0F);
}

bool PatchRefiner::refine(Map& map, std::int32_t landmark, const FrameBuilder& images, const Rigid3& T_camera_world,
                          Frame& frame, int feature) {
  const Landmark& point = map.landmark(landmark);
  if (!point.has_patch) return false;
  const auto centre = camera_.project(T_camera_world * point.p_world);
  const auto along_x = camera_.project(T_camera_world * (point.p_world + point.tangent_x.cast<double>()));
  const auto along_y = camera_.project(T_camera_world * (point.p_world + point.tangent_y.cast<double>()));
  if (!centre || !along_x || !along_y) return false;
  Eigen::Matrix2d image_per_patch;
  image_per_patch << *along_x - *centre, *along_y - *centre;
  const double size = std::sqrt(std::abs(image_per_patch.determinant()));
  if (!(size > kSmallest)) return false;
  const int nearest = static_cast<int>(std::lround(std::log(size) / log_scale_));
  const PyramidLevel& level = images.level(std::clamp(nearest, 0, map.num_levels() - 1));
  const Eigen::Matrix2d inverse = (image_per_patch / level.scale).inverse();
  const float patch_per_image[4] = {static_cast<float>(inverse(0, 0)), static_cast<float>(inverse(0, 1)),
                                    static_cast<float>(inverse(1, 0)), static_cast<float>(inverse(1, 1))};
  const std::size_t k = static_cast<std::size_t>(feature);
  const float x = (frame.features.x[k] + 0.5F) / level.scale - 0.5F;
  const float y = (frame.features.y[k] + 0.5F) / level.scale - 0.5F;
  const PatchPlace place = find_patch(map.patch(landmark), patch_per_image, level, x, y, kMaxShiftPx);
  if (!place.converged || place.correlation < kMinCorrelation) return false;
  images.place(frame, feature, (place.x + 0.5F) * level.scale - 0.5F, (place.y + 0.5F) * level.scale - 0.5F,
               static_cast<float>(sigma_px()) * level.scale);
  level_scale_[k] = level.scale;
  return true;
}

void PatchRefiner::learn(int feature, double residual_px) {
  const float scale = level_scale_[static_cast<std::size_t>(feature)];
  if (scale > 0.0F) noise_.add(residual_px / (sigma_px_ * static_cast<double>(scale)));
}

}  // namespace povslam
