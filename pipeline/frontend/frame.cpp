#include "pipeline/frontend/frame.hpp"

#include <cmath>

namespace povslam {

namespace {

struct Bounds {
  float min_x, min_y, max_x, max_y;
};

// Where the border of the image lies once rectified.
Bounds rectified_bounds(const PinholeCamera& camera) {
  Bounds b{0.0F, 0.0F, static_cast<float>(camera.width - 1), static_cast<float>(camera.height - 1)};
  const auto cover = [&b, &camera](double u, double v) {
    const Eigen::Vector2d p = camera.rectify({u, v});
    b.min_x = std::min(b.min_x, static_cast<float>(p.x()));
    b.min_y = std::min(b.min_y, static_cast<float>(p.y()));
    b.max_x = std::max(b.max_x, static_cast<float>(p.x()));
    b.max_y = std::max(b.max_y, static_cast<float>(p.y()));
  };
  for (int u = 0; u < camera.width; u += 8) cover(u, 0.0), cover(u, camera.height - 1.0);
  for (int v = 0; v < camera.height; v += 8) cover(0.0, v), cover(camera.width - 1.0, v);
  return b;
}

FeatureGrid make_grid(const PinholeCamera& camera, int capacity) {
  const Bounds b = rectified_bounds(camera);
  return {capacity, b.min_x, b.min_y, b.max_x, b.max_y};
}

}  // namespace

Frame::Frame(const PinholeCamera& camera, const FrontendOptions& options)
    : features(options.orb.num_features), grid(make_grid(camera, options.orb.num_features)) {
  const std::size_t capacity = static_cast<std::size_t>(options.orb.num_features);
  x.resize(capacity);
  y.resize(capacity);
  inverse_depth.resize(capacity);
  sigma_inverse_depth.resize(capacity);
  landmark.resize(capacity, kNone);
}

Eigen::Vector3d Frame::point_camera(int i, const PinholeCamera& camera) const {
  const std::size_t k = static_cast<std::size_t>(i);
  const double z = 1.0 / static_cast<double>(inverse_depth[k]);
  return {(x[k] - camera.cx) / camera.fx * z, (y[k] - camera.cy) / camera.fy * z, z};
}

FrameBuilder::FrameBuilder(const PinholeCamera& camera, const FrontendOptions& options)
    : camera_(camera),
      noise_(options.noise),
      extractor_(camera.width, camera.height, options.orb),
      grey_(camera.width, camera.height) {
  EXPECTS(camera.valid());
  for (int level = 0; level < extractor_.num_levels(); ++level) scales_.push_back(extractor_.scale(level));
}

void FrameBuilder::build(const RgbdFrame& input, Frame& frame) {
  EXPECTS(input.color.width() == camera_.width && input.color.height() == camera_.height);
  EXPECTS(input.depth.width() == camera_.width && input.depth.height() == camera_.height);
  frame.stamp = input.stamp;
  const std::uint8_t* grey = input.color.data();
  if (input.color.channels() == 3) {
    rgb_to_grey(input.color.data(), grey_.data(), static_cast<std::int64_t>(grey_.size()));
    grey = grey_.data();
  }
  extractor_.extract(grey, camera_.width, frame.features);
  rectify(frame);
  measure_depth(input, frame);
  std::fill_n(frame.landmark.begin(), frame.size(), kNone);
  const std::size_t n = static_cast<std::size_t>(frame.size());
  frame.grid.build({frame.x.data(), n}, {frame.y.data(), n});
}

void FrameBuilder::rectify(Frame& frame) const {
  const bool distorted = camera_.distorted();
  for (std::size_t i = 0; i < static_cast<std::size_t>(frame.size()); ++i) {
    Eigen::Vector2d p(frame.features.x[i], frame.features.y[i]);
    if (distorted) p = camera_.rectify(p);
    frame.x[i] = static_cast<float>(p.x());
    frame.y[i] = static_cast<float>(p.y());
  }
}

// Depth of a feature: the mean inverse depth of the readings around it that lie on the nearest surface. Inverse depth is
// linear across a plane's image, so the mean over a symmetric window has no bias; readings of the background behind an
// edge are left out, since a corner on an edge belongs to what is in front.
void FrameBuilder::measure_depth(const RgbdFrame& input, Frame& frame) const {
  constexpr int kRadius = 2;
  const float scale = input.depth_scale;
  const float nearest = static_cast<float>(noise_.min_depth_m), farthest = static_cast<float>(noise_.max_depth_m);
  const float sigma_one = static_cast<float>(noise_.depth_sigma_quadratic_per_m);
  for (std::size_t i = 0; i < static_cast<std::size_t>(frame.size()); ++i) {
    frame.inverse_depth[i] = 0.0F;
    frame.sigma_inverse_depth[i] = 1.0F;
    const int u = static_cast<int>(std::lround(frame.features.x[i]));
    const int v = static_cast<int>(std::lround(frame.features.y[i]));
    if (u < kRadius || v < kRadius || u >= camera_.width - kRadius || v >= camera_.height - kRadius) continue;
    float front = 0.0F;  // largest inverse depth in the inner 3x3
    for (int dv = -1; dv <= 1; ++dv) {
      for (int du = -1; du <= 1; ++du) {
        const float z = static_cast<float>(input.depth.at(u + du, v + dv)) / scale;
        if (z >= nearest && z <= farthest) front = std::max(front, 1.0F / z);
      }
    }
    if (front == 0.0F) continue;
    const float tolerance = std::max(6.0F * sigma_one, 0.04F * front);
    float sum = 0.0F;
    int count = 0, behind = 0;
    for (int dv = -kRadius; dv <= kRadius; ++dv) {
      for (int du = -kRadius; du <= kRadius; ++du) {
        const float z = static_cast<float>(input.depth.at(u + du, v + dv)) / scale;
        if (z < nearest || z > farthest) continue;
        if (front - 1.0F / z > tolerance) {
          ++behind;
          continue;
        }
        sum += 1.0F / z;
        ++count;
      }
    }
    if (count < 4) continue;
    const float inverse = sum / static_cast<float>(count);
    const float floor = static_cast<float>(noise_.depth_sigma_floor_m) * inverse * inverse;
    // Neighbouring readings share much of their error: averaging is trusted for a factor of two at most. On an edge
    // the surface itself is uncertain.
    const float gain = std::min(2.0F, std::sqrt(static_cast<float>(count)));
    const float edge = behind > 3 ? 3.0F : 1.0F;
    frame.inverse_depth[i] = inverse;
    frame.sigma_inverse_depth[i] = edge * std::sqrt(sigma_one * sigma_one / (gain * gain) + floor * floor);
  }
}

}  // namespace povslam
