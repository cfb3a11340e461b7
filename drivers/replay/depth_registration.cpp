#include "drivers/replay/depth_registration.hpp"

#include <algorithm>
#include <cmath>

namespace povslam {

namespace {

// Neighbouring depth pixels of a slanted surface move apart by parallax and lens; without some slack pinholes would
// open.
constexpr double kFootprintSlack = 1.3;

}  // namespace

DepthRegistration::DepthRegistration(const DepthCamera& depth, const PinholeCamera& color, double depth_scale)
    : color_(color),
      width_(depth.camera.width),
      height_(depth.camera.height),
      translation_((depth.T_color_depth.translation * depth_scale).cast<float>()),
      half_x_(static_cast<float>(0.5 * kFootprintSlack * color.fx / depth.camera.fx)),
      half_y_(static_cast<float>(0.5 * kFootprintSlack * color.fy / depth.camera.fy)) {
  EXPECTS(depth.camera.valid() && color.valid() && depth_scale > 0.0);
  rays_color_.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const Eigen::Vector3d ray = depth.T_color_depth.rotation * depth.camera.unproject(Eigen::Vector2d(x, y));
      rays_color_.push_back(ray.cast<float>());
    }
  }
}

void DepthRegistration::warp(const ImageU16& depth, ImageU16& registered) const {
  EXPECTS(depth.width() == width_ && depth.height() == height_);
  registered.resize(color_.width, color_.height);
  registered.fill(0);
  const bool distorted = color_.distorted();
  const std::uint16_t* in = depth.data();
  for (std::size_t i = 0; i < rays_color_.size(); ++i) {
    if (in[i] == 0) continue;
    const float z_depth = in[i];
    const Eigen::Vector3f p_color = rays_color_[i] * z_depth + translation_;  // in depth units
    if (!(p_color.z() >= 1.0F && p_color.z() < 65535.0F)) continue;
    Eigen::Vector2f plane = p_color.head<2>() / p_color.z();
    if (distorted) plane = color_.distort(plane.cast<double>()).cast<float>();
    cover(plane, p_color.z(), z_depth / p_color.z(), registered);
  }
}

void DepthRegistration::cover(const Eigen::Vector2f& plane, float z_color, float scale, ImageU16& registered) const {
  const float u = static_cast<float>(color_.fx) * plane.x() + static_cast<float>(color_.cx);
  const float v = static_cast<float>(color_.fy) * plane.y() + static_cast<float>(color_.cy);
  const float half_u = half_x_ * scale, half_v = half_y_ * scale;
  const auto width = static_cast<float>(color_.width), height = static_cast<float>(color_.height);
  const bool inside = u + half_u >= 0.0F && v + half_v >= 0.0F && u - half_u < width && v - half_v < height;
  if (!inside) return;
  const int left = static_cast<int>(std::ceil(std::max(0.0F, u - half_u)));
  const int right = static_cast<int>(std::min(width - 1.0F, u + half_u));
  const int top = static_cast<int>(std::ceil(std::max(0.0F, v - half_v)));
  const int bottom = static_cast<int>(std::min(height - 1.0F, v + half_v));
  const auto z = static_cast<std::uint16_t>(z_color + 0.5F);
  for (int y = top; y <= bottom; ++y) {
    std::uint16_t* row = registered.row(y);
    for (int x = left; x <= right; ++x) {
      if (row[x] == 0 || z < row[x]) row[x] = z;
    }
  }
}

}  // namespace povslam
