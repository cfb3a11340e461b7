// Depth views of boxes on a floor, cast ray by ray, with the thing that each pixel shows.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <vector>

#include "pipeline/objects/segment.hpp"

namespace povslam {

struct AnalyticBox {  // upright
  int thing = 1;      // 0: part of the building
  Eigen::Vector3d center_world, size_m;
  double yaw = 0.0;
};

struct AnalyticScene {
  std::vector<AnalyticBox> boxes;
  bool floor = true;   // at the world's height 0
  double noise = 0.0;  // sigma_z = noise * z^2
  PinholeCamera camera{640, 480, 525.0, 525.0, 319.5, 239.5, {}};
  double camera_height_m = 1.0, pitch_rad = 0.25;  // looks along +x, down by the pitch
};

struct AnalyticView {
  DepthView view;
  Image<int> thing;  // -1: nothing, 0: building, floor
};

inline double range_along(const AnalyticBox& box, const Eigen::Vector3d& from, const Eigen::Vector3d& ray) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(-box.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Array3d origin = (R * (from - box.center_world)).array(), direction = (R * ray).array();
  const Eigen::Array3d half = 0.5 * box.size_m.array();
  const Eigen::Array3d a = (-half - origin) / direction, b = (half - origin) / direction;
  const double enter = a.min(b).maxCoeff(), leave = a.max(b).minCoeff();
  return enter > 0.0 && enter < leave ? enter : std::numeric_limits<double>::infinity();
}

inline Rigid3 looking_along_x(double height_m, double pitch_rad) {
  Eigen::Matrix3d R_level_camera;
  R_level_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::AngleAxisd down(pitch_rad, Eigen::Vector3d::UnitY());
  return {Eigen::Quaterniond(down * R_level_camera), {0.0, 0.0, height_m}};
}

inline AnalyticView cast(const AnalyticScene& scene) {
  AnalyticView out;
  const PinholeCamera& camera = scene.camera;
  out.view.camera = camera;
  out.view.T_world_camera = looking_along_x(scene.camera_height_m, scene.pitch_rad);
  out.view.depth_m.resize(camera.width, camera.height);
  out.thing.resize(camera.width, camera.height);
  const Eigen::Matrix3d R = out.view.T_world_camera.matrix3();
  const Eigen::Vector3d from = out.view.T_world_camera.translation;
  std::mt19937 random(1);
  std::normal_distribution<double> gaussian;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = R * Eigen::Vector3d((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0);
      double depth = scene.floor && ray.z() < 0.0 ? -from.z() / ray.z() : std::numeric_limits<double>::infinity();
      int thing = std::isfinite(depth) ? 0 : -1;
      for (const AnalyticBox& box : scene.boxes) {
        const double range = range_along(box, from, ray);
        if (range < depth) {
          depth = range;
          thing = box.thing;
        }
      }
      depth += scene.noise * depth * depth * gaussian(random);
      const bool seen = depth < 5.0;
      out.view.depth_m.at(x, y) = seen ? static_cast<float>(depth) : 0.0F;
      out.thing.at(x, y) = seen ? thing : -1;
    }
  }
  return out;
}

// Best intersection over union of a thing's pixels with any one segment's.
inline double best_iou(const AnalyticView& truth, const ImageU16& instances, int thing) {
  std::map<int, int> both, segment;
  int whole = 0;
  for (std::size_t i = 0; i < instances.size(); ++i) {
    const int instance = instances.data()[i];
    const bool here = truth.thing.data()[i] == thing;
    whole += here;
    if (instance < kFirstInstance) continue;
    ++segment[instance];
    both[instance] += here;
  }
  double best = 0.0;
  for (const auto& [instance, count] : both)
    best = std::max(best, static_cast<double>(count) / (whole + segment[instance] - count));
  return best;
}

// Share of a thing's pixels that have that owner.
inline double share_owned(const AnalyticView& truth, const ImageU16& instances, int thing, int owner) {
  int whole = 0, owned = 0;
  for (std::size_t i = 0; i < instances.size(); ++i) {
    if (truth.thing.data()[i] != thing) continue;
    ++whole;
    owned += instances.data()[i] == owner;
  }
  return whole == 0 ? 0.0 : static_cast<double>(owned) / whole;
}

}  // namespace povslam
