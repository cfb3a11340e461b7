// Frames, keyframes and landmarks made by hand, without images, for tests of what is done with them.
#pragma once

#include <random>
#include <span>
#include <vector>

#include "pipeline/frontend/frame.hpp"
#include "pipeline/frontend/map.hpp"

namespace povslam::made {

inline PinholeCamera half_camera() {
  return {320, 240, 262.5, 262.5, 159.5, 119.5, {}};
}

inline std::vector<float> level_scales(int count = 8) {
  std::vector<float> scales{1.0F};
  while (static_cast<int>(scales.size()) < count) scales.push_back(scales.back() * 1.2F);
  return scales;
}

inline Descriptor random_descriptor(std::mt19937_64& random) {
  return {random(), random(), random(), random()};
}

// A camera at the place that looks along world y, x to its right.
inline Rigid3 looking_along_y(const Eigen::Vector3d& place) {
  Eigen::Matrix3d R_world_camera;
  R_world_camera << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return {Eigen::Quaterniond(R_world_camera), place};
}

// Points in front of such cameras that stand near the origin.
inline std::vector<Eigen::Vector3d> cloud(int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> side(-2.0, 2.0), height(-1.0, 1.0), far(2.5, 5.0);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const double x = side(random), y = far(random), z = height(random);
    points.emplace_back(x, y, z);
  }
  return points;
}

// `size` features without any sense, each with depth and a look of its own.
inline Frame random_frame(const PinholeCamera& camera, const FrontendOptions& options, int size, unsigned seed) {
  Frame frame(camera, options);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<float> u(20.0F, 300.0F), v(20.0F, 220.0F), inverse_depth(0.2F, 1.0F);
  frame.features.size = size;
  for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) {
    frame.features.x[i] = frame.x[i] = frame.x_seen[i] = u(random);
    frame.features.y[i] = frame.y[i] = frame.y_seen[i] = v(random);
    frame.inverse_depth[i] = inverse_depth(random);
    frame.sigma_inverse_depth[i] = 0.0025F;
    frame.sigma_px[i] = 0.8F;
    frame.features.level[i] = 0;
    frame.features.descriptor[i] = random_descriptor(random);
  }
  const std::size_t n = static_cast<std::size_t>(size);
  frame.grid.build({frame.x.data(), n}, {frame.y.data(), n});
  return frame;
}

// What the camera sees of the points: feature k shows point shown[k], all with depth and no noise. The look of point i
// is looks[i].
struct View {
  Frame frame;
  std::vector<int> shown;
};
inline View view_of(const PinholeCamera& camera, const FrontendOptions& options, const Rigid3& T_world_camera,
                    std::span<const Eigen::Vector3d> points, std::span<const Descriptor> looks) {
  View view{Frame(camera, options), {}};
  Frame& frame = view.frame;
  frame.T_camera_world = T_world_camera.inverse();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = frame.T_camera_world * points[i];
    const auto pixel = camera.project(p);
    if (!pixel || !camera.contains(*pixel) || frame.size() == frame.features.capacity) continue;
    const std::size_t k = static_cast<std::size_t>(frame.features.size++);
    frame.features.x[k] = frame.x[k] = frame.x_seen[k] = static_cast<float>(pixel->x());
    frame.features.y[k] = frame.y[k] = frame.y_seen[k] = static_cast<float>(pixel->y());
    frame.inverse_depth[k] = static_cast<float>(1.0 / p.z());
    frame.sigma_inverse_depth[k] = 0.0025F;
    frame.sigma_px[k] = 0.8F;
    frame.features.level[k] = 0;
    frame.features.descriptor[k] = looks[i];
    frame.landmark[k] = kNone;
    view.shown.push_back(static_cast<int>(i));
  }
  const std::size_t n = view.shown.size();
  frame.grid.build({frame.x.data(), n}, {frame.y.data(), n});
  return view;
}

inline std::vector<Descriptor> looks(std::size_t count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::vector<Descriptor> descriptors(count);
  for (Descriptor& d : descriptors) d = random_descriptor(random);
  return descriptors;
}

}  // namespace povslam::made
