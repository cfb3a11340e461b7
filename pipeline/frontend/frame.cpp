#include "pipeline/frontend/frame.hpp"

#include <array>
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

constexpr int kSlope = 6;  // px: half width of what tells the slope

struct Readings {
  float mean = 0.0F;
  int count = 0, behind = 0;  // of the surface; farther than it
};

// Of inverse depths (0: none), those within the tolerance of the nearest surface's mean. That is looked for from the
// front backwards: the nearest reading of many is nearer than the surface, by as much as the sensor is noisy, and a
// tolerance counted from it would cut the surface's back half off. All depth would be too near by a constant share,
// which no loop closure takes out again.
constexpr int kWindow = 25;
Readings nearest_surface(const std::array<float, kWindow>& inverse, float front, float tolerance) {
  constexpr int kRounds = 10;
  Readings now;
  float middle = front;
  for (int round = 0; round < kRounds; ++round) {
    float sum = 0.0F;
    now = {};
    for (const float reading : inverse) {
      if (reading == 0.0F || reading - middle > tolerance) continue;
      const bool on_it = middle - reading <= tolerance;
      sum += on_it ? reading : 0.0F;
      ++(on_it ? now.count : now.behind);
    }
    if (now.count == 0) return now;
    now.mean = sum / static_cast<float>(now.count);
    if (now.mean == middle) break;
    middle = now.mean;
  }
  return now;
}

struct Slope {
  float x = 0.0F, y = 0.0F;
};

template <class InverseAt>
Slope slope_of(const InverseAt& inverse_at, float tolerance) {
  float along_x = 0.0F, along_y = 0.0F, weight = 0.0F;
  for (int k = 2; k <= kSlope; k += 2) {  // opposite readings in pairs: their difference is the slope
    for (int side = -2; side <= 2; side += 2) {
      const float right = inverse_at(k, side), left = inverse_at(-k, side);
      const float low = inverse_at(side, k), high = inverse_at(side, -k);
      const float limit = tolerance * static_cast<float>(k);
      const bool whole = right > 0.0F && left > 0.0F && low > 0.0F && high > 0.0F;
      if (!whole || std::abs(right - left) > limit || std::abs(low - high) > limit) continue;
      along_x += static_cast<float>(k) * (right - left);
      along_y += static_cast<float>(k) * (low - high);
      weight += static_cast<float>(2 * k * k);
    }
  }
  // Few pairs say little: the slope leans towards zero (facing the camera).
  constexpr float kLean = 60.0F;
  return {along_x / (weight + kLean), along_y / (weight + kLean)};
}

}  // namespace

Frame::Frame(const PinholeCamera& camera, const FrontendOptions& options)
    : features(options.orb.num_features), grid(make_grid(camera, options.orb.num_features)) {
  const std::size_t capacity = static_cast<std::size_t>(options.orb.num_features);
  x_seen.resize(capacity);
  y_seen.resize(capacity);
  x.resize(capacity);
  y.resize(capacity);
  inverse_depth.resize(capacity);
  sigma_inverse_depth.resize(capacity);
  slope_x.resize(capacity);
  slope_y.resize(capacity);
  sigma_px.resize(capacity);
  landmark.resize(capacity, kNone);
  misfit.resize(capacity, kNone);
}

Eigen::Vector3d Frame::point_camera(int i, const PinholeCamera& camera) const {
  const std::size_t k = static_cast<std::size_t>(i);
  const double z = 1.0 / static_cast<double>(inverse_depth[k]);
  return {(x[k] - camera.cx) / camera.fx * z, (y[k] - camera.cy) / camera.fy * z, z};
}

// A point seen at p while the camera moves with (v, w) is, dt earlier or later, at p + dt (v + w x p).
void Frame::compensate_motion(const PinholeCamera& camera, const Vector6d& twist, double readout_s) {
  constexpr double kTypicalInverseDepth = 0.5;
  const Eigen::Vector3d v = twist.head<3>(), w = twist.tail<3>();
  for (std::size_t i = 0; i < static_cast<std::size_t>(size()); ++i) {
    const double dt_s = (static_cast<double>(features.y[i]) / (camera.height - 1) - 0.5) * readout_s;
    const Eigen::Vector3d ray((x_seen[i] - camera.cx) / camera.fx, (y_seen[i] - camera.cy) / camera.fy, 1.0);
    const double inverse = inverse_depth[i] > 0.0F ? inverse_depth[i] : kTypicalInverseDepth;
    const Eigen::Vector3d moved = ray + dt_s * (v * inverse + w.cross(ray));
    x[i] = static_cast<float>(camera.fx * moved.x() / moved.z() + camera.cx);
    y[i] = static_cast<float>(camera.fy * moved.y() / moved.z() + camera.cy);
  }
  const std::size_t n = static_cast<std::size_t>(size());
  grid.build({x.data(), n}, {y.data(), n});
}

FrameBuilder::FrameBuilder(const PinholeCamera& camera, const FrontendOptions& options)
    : camera_(camera),
      noise_(options.noise),
      extractor_(camera.width, camera.height, options.orb),
      grey_(camera.width, camera.height) {
  EXPECTS(camera.valid());
  distorted_ = camera.distorted();
  for (int level = 0; level < extractor_.num_levels(); ++level) scales_.push_back(extractor_.scale(level));
}

void FrameBuilder::build(const RgbdFrame& input, double depth_noise_factor, Frame& frame,
                         std::span<const FeatureWish> wishes) {
  EXPECTS(input.color.width() == camera_.width && input.color.height() == camera_.height);
  EXPECTS(input.depth.width() == camera_.width && input.depth.height() == camera_.height);
  frame.stamp = input.stamp;
  const std::uint8_t* grey = input.color.data();
  if (input.color.channels() == 3) {
    rgb_to_grey(input.color.data(), grey_.data(), static_cast<std::int64_t>(grey_.size()));
    grey = grey_.data();
  }
  extractor_.extract(grey, camera_.width, frame.features, wishes);
  rectify(frame);
  measure_depth(input, depth_noise_factor, frame);
  std::fill_n(frame.landmark.begin(), frame.size(), kNone);
  std::fill_n(frame.misfit.begin(), frame.size(), kNone);
  const std::size_t n = static_cast<std::size_t>(frame.size());
  frame.grid.build({frame.x.data(), n}, {frame.y.data(), n});
}

void FrameBuilder::rectify(Frame& frame) const {
  for (int i = 0; i < frame.size(); ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const float sigma = static_cast<float>(noise_.pixel_sigma_px) * level_scale(frame.features.level[k]);
    place(frame, i, frame.features.x[k], frame.features.y[k], sigma);
  }
}

void FrameBuilder::place(Frame& frame, int feature, float x_raw, float y_raw, float sigma_px) const {
  const std::size_t k = static_cast<std::size_t>(feature);
  Eigen::Vector2d p(x_raw, y_raw);
  if (distorted_) p = camera_.rectify(p);
  frame.features.x[k] = x_raw;
  frame.features.y[k] = y_raw;
  frame.x[k] = frame.x_seen[k] = static_cast<float>(p.x());
  frame.y[k] = frame.y_seen[k] = static_cast<float>(p.y());
  frame.sigma_px[k] = sigma_px;
}

// Depth of a feature: the mean inverse depth of the readings around it that lie on the nearest surface, and how it
// slopes. Inverse depth is linear across a plane's image, so the mean over a symmetric window has no bias; readings of
// the background behind an edge are left out, since a corner on an edge belongs to what is in front.
void FrameBuilder::measure_depth(const RgbdFrame& input, double noise_factor, Frame& frame) const {
  for (std::size_t i = 0; i < static_cast<std::size_t>(frame.size()); ++i) {
    const Surface surface = measure_surface(input, frame.features.x[i], frame.features.y[i]);
    frame.inverse_depth[i] = surface.inverse_depth;
    frame.sigma_inverse_depth[i] = static_cast<float>(noise_factor) * surface.sigma;
    frame.slope_x[i] = surface.slope_x;
    frame.slope_y[i] = surface.slope_y;
  }
}

FrameBuilder::Surface FrameBuilder::measure_surface(const RgbdFrame& input, float x, float y) const {
  constexpr int kInner = 1, kMean = 2;  // px: half widths
  static_assert(kWindow == (2 * kMean + 1) * (2 * kMean + 1));
  const float nearest = static_cast<float>(noise_.min_depth_m), farthest = static_cast<float>(noise_.max_depth_m);
  const float sigma_one = static_cast<float>(noise_.depth_sigma_quadratic_per_m);
  const int u = static_cast<int>(std::lround(x)), v = static_cast<int>(std::lround(y));
  Surface surface;
  if (u < kSlope || v < kSlope || u >= camera_.width - kSlope || v >= camera_.height - kSlope) return surface;
  const auto inverse_at = [&](int du, int dv) {  // 0: no reading
    const float z = static_cast<float>(input.depth.at(u + du, v + dv)) / input.depth_scale;
    return z >= nearest && z <= farthest ? 1.0F / z : 0.0F;
  };
  float front = 0.0F;
  for (int dv = -kInner; dv <= kInner; ++dv) {
    for (int du = -kInner; du <= kInner; ++du) front = std::max(front, inverse_at(du, dv));
  }
  if (front == 0.0F) return surface;
  std::array<float, kWindow> around;
  std::size_t k = 0;
  for (int dv = -kMean; dv <= kMean; ++dv) {
    for (int du = -kMean; du <= kMean; ++du) around[k++] = inverse_at(du, dv);
  }
  const float tolerance = std::max(6.0F * sigma_one, 0.04F * front);
  const Readings near = nearest_surface(around, front, tolerance);
  if (near.count < 4) return surface;
  const Slope slope = slope_of(inverse_at, tolerance);
  surface.slope_x = slope.x;
  surface.slope_y = slope.y;
  surface.inverse_depth = near.mean;
  // Neighbouring readings share much of their error: averaging is trusted for a factor of two at most. On an edge
  // the surface itself is uncertain.
  const float floor = static_cast<float>(noise_.depth_sigma_floor_m) * near.mean * near.mean;
  const float gain = std::min(2.0F, std::sqrt(static_cast<float>(near.count)));
  const float edge = near.behind > 3 ? 3.0F : 1.0F;
  surface.sigma = edge * std::sqrt(sigma_one * sigma_one / (gain * gain) + floor * floor);
  return surface;
}

}  // namespace povslam
