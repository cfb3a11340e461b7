// Depth views of balls, boxes and planes, by intersecting rays: the truth is known exactly.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <variant>
#include <vector>

#include "pipeline/mapping/depth_view.hpp"

namespace povslam {

struct Ball {
  Eigen::Vector3d centre;
  double radius_m;
};
struct Box {  // upright, axes along the world's
  Eigen::Vector3d low, high;
};
struct Wall {  // endless
  Eigen::Vector3d normal;
  double offset_m;  // normal . p = offset
};

struct Thing {
  std::variant<Ball, Box, Wall> shape;
  std::uint16_t owner = kStructure;
  std::array<std::uint8_t, 3> color{128, 128, 128};
};

// Of a ray from `start`, the parameter of its first entry; nothing if it misses.
inline std::optional<double> hit(const Ball& ball, const Eigen::Vector3d& start, const Eigen::Vector3d& ray) {
  const Eigen::Vector3d to = start - ball.centre;
  const double a = ray.squaredNorm(), b = to.dot(ray), c = to.squaredNorm() - ball.radius_m * ball.radius_m;
  const double root = b * b - a * c;
  if (root < 0.0) return std::nullopt;
  const double at = (-b - std::sqrt(root)) / a;
  return at > 0.0 ? std::optional(at) : std::nullopt;
}
inline std::optional<double> hit(const Box& box, const Eigen::Vector3d& start, const Eigen::Vector3d& ray) {
  double enter = 0.0, leave = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.low[axis] - start[axis]) / ray[axis], b = (box.high[axis] - start[axis]) / ray[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter > 0.0 && enter < leave ? std::optional(enter) : std::nullopt;
}
inline std::optional<double> hit(const Wall& wall, const Eigen::Vector3d& start, const Eigen::Vector3d& ray) {
  const double at = (wall.offset_m - wall.normal.dot(start)) / wall.normal.dot(ray);
  return std::isfinite(at) && at > 0.0 ? std::optional(at) : std::nullopt;
}

inline PinholeCamera small_camera() {
  return {320, 240, 262.5, 262.5, 159.5, 119.5, {}};
}

// Camera at `eye`, looking at `target`, the image's down along the world's -z.
inline Rigid3 looking(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d up = std::abs(forward.z()) > 0.99 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d right = forward.cross(up).normalized();
  Eigen::Matrix3d axes;
  axes << right, forward.cross(right), forward;
  return {Eigen::Quaterniond(axes), eye};
}

struct RenderOptions {
  double noise = 0.0;         // factor on sigma = 0.0025 z^2
  double flying_share = 0.0;  // of the pixels at depth edges: anywhere between the two depths
  int doubt_px = 0;           // pixels so near to a depth edge are nobody's
  unsigned seed = 1;
};

inline void blur_edges(DepthView& view, const RenderOptions& options, std::mt19937& random) {
  const ImageF truth = view.depth_m;
  const ImageU16 owner = view.owner;
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  for (int y = 1; y + 1 < truth.height(); ++y) {
    for (int x = 1; x + 1 < truth.width(); ++x) {
      const float here = truth.at(x, y);
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const float there = truth.at(x + dx, y + dy);
        if (std::abs(there - here) < 0.1F) continue;
        if (uniform(random) < static_cast<float>(options.flying_share)) {
          view.depth_m.at(x, y) = here + (there - here) * uniform(random);
        }
        for (int v = std::max(y - options.doubt_px + 1, 0); v < std::min(y + options.doubt_px, truth.height()); ++v) {
          for (int u = std::max(x - options.doubt_px + 1, 0); u < std::min(x + options.doubt_px, truth.width()); ++u) {
            view.owner.at(u, v) = kNobody;
          }
        }
      }
    }
  }
}

inline DepthView render(const std::vector<Thing>& things, const Rigid3& T_world_camera,
                        const RenderOptions& options = {}, const PinholeCamera& camera = small_camera()) {
  DepthView view;
  view.camera = camera;
  view.T_world_camera = T_world_camera;
  view.depth_m.resize(camera.width, camera.height);
  view.owner.resize(camera.width, camera.height);
  view.color.resize(camera.width, camera.height, 3);
  std::mt19937 random(options.seed);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = T_world_camera.rotation * camera.unproject({x, y});
      double depth_m = view.max_depth_m;
      const Thing* nearest = nullptr;
      for (const Thing& thing : things) {
        const auto at = std::visit([&](const auto& s) { return hit(s, T_world_camera.translation, ray); }, thing.shape);
        if (at && *at >= view.min_depth_m && *at < depth_m) depth_m = *at, nearest = &thing;
      }
      view.depth_m.at(x, y) = nearest != nullptr ? static_cast<float>(depth_m) : 0.0F;
      view.owner.at(x, y) = nearest != nullptr ? nearest->owner : kNobody;
      for (int c = 0; c < 3; ++c) {
        view.color.at(x, y, c) = nearest != nullptr ? nearest->color[static_cast<std::size_t>(c)] : 0;
      }
    }
  }
  blur_edges(view, options, random);
  std::normal_distribution<float> gauss;
  for (float& d : view.depth_m.pixels()) d += static_cast<float>(options.noise) * 0.0025F * d * d * gauss(random);
  return view;
}

// Eyes on a ring around `target`, looking at it.
inline std::vector<Rigid3> ring(const Eigen::Vector3d& target, double radius_m, double height_m, int count) {
  std::vector<Rigid3> poses;
  for (int k = 0; k < count; ++k) {
    const double angle = 2.0 * M_PI * k / count;
    const Eigen::Vector3d off(radius_m * std::cos(angle), radius_m * std::sin(angle), height_m);
    poses.push_back(looking(target + off, target));
  }
  return poses;
}

}  // namespace povslam
