// A few upright boxes on a floor before a wall, as a depth camera with labels sees them.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "pipeline/objects/class_table.hpp"
#include "pipeline/objects/observation.hpp"

namespace povslam {

struct SmallWorld {
  static constexpr std::uint8_t kFloor = 1, kWall = 2, kCarton = 3, kPallet = 4, kPerson = 5;
  struct Thing {
    Box box;
    std::uint8_t class_id = kCarton;
    std::uint8_t shade = 120;
  };
  std::vector<Thing> things;
  double noise = 1.0;  // factor on sigma = 0.0025 z^2
  std::mt19937 random{5};

  static ClassTable classes() {
    return {"small",
            {make_class(0, "unlabelled", ClassKind::ignore), make_class(kFloor, "floor", ClassKind::structure),
             make_class(kWall, "wall", ClassKind::structure), make_class(kCarton, "carton", ClassKind::semi_static),
             make_class(kPallet, "pallet", ClassKind::semi_static), make_class(kPerson, "person", ClassKind::dynamic)}};
  }
  static PinholeCamera camera() { return {320, 240, 262.5, 262.5, 159.5, 119.5, {}}; }

  // Level, at 0.8 m, looking from `eye` to `target`.
  static Rigid3 looking(const Eigen::Vector2d& eye, const Eigen::Vector2d& target) {
    const Eigen::Vector2d ahead = (target - eye).normalized();
    Eigen::Matrix3d axes;
    axes << Eigen::Vector3d(ahead.y(), -ahead.x(), 0.0), Eigen::Vector3d(0.0, 0.0, -1.0),
        Eigen::Vector3d(ahead.x(), ahead.y(), 0.0);
    return {Eigen::Quaterniond(axes), {eye.x(), eye.y(), 0.8}};
  }

  // The wall stands at x = 7.
  void look(const Rigid3& T_world_camera, TimeNs stamp, DepthView& view, ImageU8& labels) {
    view.stamp = stamp;
    view.camera = camera();
    view.T_world_camera = T_world_camera;
    view.depth_m.resize(view.camera.width, view.camera.height);
    view.owner.resize(view.camera.width, view.camera.height);
    view.owner.fill(kNobody);
    view.color.resize(view.camera.width, view.camera.height, 3);
    labels.resize(view.camera.width, view.camera.height);
    std::normal_distribution<double> gauss;
    for (int y = 0; y < view.camera.height; ++y) {
      for (int x = 0; x < view.camera.width; ++x) {
        const Eigen::Vector3d ray = T_world_camera.rotation * view.camera.unproject({x, y});
        const auto [z, class_id, shade] = hit(T_world_camera.translation, ray);
        const double measured = z + noise * 0.0025 * z * z * gauss(random);
        view.depth_m.at(x, y) = z < 8.0 ? static_cast<float>(measured) : 0.0F;
        labels.at(x, y) = class_id;
        for (int c = 0; c < 3; ++c) view.color.at(x, y, c) = shade;
      }
    }
  }

 private:
  struct Hit {
    double z = 1e9;
    std::uint8_t class_id = 0, shade = 0;
  };
  Hit hit(const Eigen::Vector3d& start, const Eigen::Vector3d& ray) const {
    Hit nearest;
    const auto take = [&](double at, std::uint8_t class_id, std::uint8_t shade) {
      if (at > 0.1 && at < nearest.z) nearest = {at, class_id, shade};
    };
    take(-start.z() / ray.z(), kFloor, 60);
    take((7.0 - start.x()) / ray.x(), kWall, 200);
    for (const Thing& thing : things) {
      const Eigen::AngleAxisd back(-thing.box.yaw, Eigen::Vector3d::UnitZ());
      const Eigen::Vector3d p = back * (start - thing.box.center), d = back * ray;
      double enter = -1e9, leave = 1e9;
      for (int axis = 0; axis < 3; ++axis) {
        const double half = 0.5 * thing.box.size_m[axis];
        const double a = (-half - p[axis]) / d[axis], b = (half - p[axis]) / d[axis];
        enter = std::max(enter, std::min(a, b)), leave = std::min(leave, std::max(a, b));
      }
      if (enter < leave) take(enter, thing.class_id, thing.shade);
    }
    return nearest;
  }
};

}  // namespace povslam
