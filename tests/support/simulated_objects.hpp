// A window of the variational EM with a known truth: boxes in a room, some of which stand elsewhere than the map says.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "pipeline/backend/window.hpp"

namespace povslam::simulated {

struct ObjectsOptions {
  int num_objects = 10, num_moved = 6, num_landmarks = 400, num_frames = 8;
  int num_structure = 0;                  // landmarks without object, seen by all frames
  double share_seen = 0.9;                // of pairs of frame and landmark
  double noise_m = 0.01, sigma_m = 0.05;  // of points in the camera: true, and said
  double shift_min_m = 0.5, shift_max_m = 1.5;
  double map_noise_m = 0.005;
  double drift_m = 0.02, drift_rad = 0.01;  // of each transition
  double start_m = 0.0, start_rad = 0.0;    // the whole window begins this far off
  double prior_sigma_m = 0.5, prior_sigma_rad = 0.2;
  unsigned seed = 1;
};

struct ObjectsWindow {
  VemWindow window;
  std::vector<Rigid3> truth;  // T_world_camera
  std::vector<char> moved;    // by object
};

class ObjectsMaker {
 public:
  explicit ObjectsMaker(const ObjectsOptions& options) : options_(options), random_(options.seed) {}

  ObjectsWindow make() {
    make_poses();
    const int each = options_.num_landmarks / options_.num_objects;
    for (int i = 0; i < options_.num_objects; ++i) add_box(i, each);
    if (options_.num_structure > 0) add_structure();
    see_all();
    return out_;
  }

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Eigen::Vector3d noise(double sigma) {
    std::normal_distribution<double> normal(0.0, 1.0);
    const double x = normal(random_), y = normal(random_), z = normal(random_);
    return sigma * Eigen::Vector3d(x, y, z);
  }

  void make_poses() {
    const Rigid3 off = {so3_exp(options_.start_rad * Eigen::Vector3d::UnitZ()),
                        options_.start_m * Eigen::Vector3d(std::cos(0.7), std::sin(0.7), 0.0)};
    for (int t = 0; t < options_.num_frames; ++t) {
      const Eigen::Quaterniond look =
          so3_exp(Eigen::Vector3d(0.0, 0.0, 0.04 * t)) * Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5);  // level, along x
      out_.truth.push_back({look, {0.1 * t, 0.03 * t, 0.8}});
    }
    VemWindow& window = out_.window;
    window.poses.push_back({off.rotation * out_.truth[0].rotation, out_.truth[0].translation + off.translation});
    window.prior = {window.poses[0], options_.prior_sigma_m, options_.prior_sigma_rad};
    for (std::size_t t = 0; t + 1 < out_.truth.size(); ++t) {
      Vector6d xi;
      xi << noise(options_.drift_m), noise(options_.drift_rad);
      const Rigid3 Z = retract(out_.truth[t].inverse() * out_.truth[t + 1], xi);
      window.transitions.push_back({Z, 2.0 * options_.drift_m + 0.005, 2.0 * options_.drift_rad + 0.002});
      window.poses.push_back(window.poses.back() * Z);
    }
  }

  void add_box(int index, int count) {
    VemWindow& window = out_.window;
    VemObject object;
    const double bearing = 2.0 * std::numbers::pi * index / options_.num_objects;
    object.position = {4.0 * std::cos(bearing) + uniform(-0.5, 0.5), 4.0 * std::sin(bearing) + uniform(-0.5, 0.5), 0.6};
    object.yaw = uniform(-3.0, 3.0);
    object.num_landmarks = count;
    const bool moved = index < options_.num_moved;
    const double way = uniform(-3.0, 3.0), length = uniform(options_.shift_min_m, options_.shift_max_m);
    const Rigid3 map{so3_exp({0.0, 0.0, object.yaw}), object.position};
    Rigid3 now = map;
    if (moved) {
      now.translation += length * Eigen::Vector3d(std::cos(way), std::sin(way), 0.0);
      now.rotation = so3_exp({0.0, 0.0, uniform(-0.5, 0.5)}) * now.rotation;
    }
    const Eigen::Vector3d half(uniform(0.3, 0.6), uniform(0.2, 0.4), 0.6);
    for (int i = 0; i < count; ++i) {
      Eigen::Vector3d on = half.cwiseProduct(Eigen::Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)));
      const int axis = i % 3;
      on[axis] = (i % 2 == 0 ? 1.0 : -1.0) * half[axis];
      const Eigen::Vector3d p_world = map * on + noise(options_.map_noise_m);
      window.landmarks.push_back({p_world, map.inverse() * p_world, p_world});
      true_.push_back(now * on);
    }
    window.objects.push_back(object);
    out_.moved.push_back(moved ? 1 : 0);
  }

  void add_structure() {
    VemObject walls;
    walls.kind = ClassKind::structure;
    walls.num_landmarks = options_.num_structure;
    for (int i = 0; i < options_.num_structure; ++i) {
      const Eigen::Vector3d p =
          6.0 * Eigen::Vector3d(std::cos(i), std::sin(i), 0.0) + Eigen::Vector3d(0, 0, uniform(0, 2));
      out_.window.landmarks.push_back({p, Eigen::Vector3d::Zero(), p});
      true_.push_back(p);
    }
    out_.window.objects.push_back(walls);
    out_.moved.push_back(0);
  }

  void see_all() {
    for (std::size_t l = 0; l < true_.size(); ++l) {
      for (int t = 0; t < options_.num_frames; ++t) {
        if (uniform(0.0, 1.0) > options_.share_seen) continue;
        const Eigen::Vector3d p_camera = out_.truth[static_cast<std::size_t>(t)].inverse() * true_[l];
        out_.window.matches.push_back(
            {t, static_cast<std::int32_t>(l), p_camera + noise(options_.noise_m), options_.sigma_m});
      }
    }
  }

  ObjectsOptions options_;
  std::mt19937 random_;
  ObjectsWindow out_;
  std::vector<Eigen::Vector3d> true_;  // where landmarks are
};

inline ObjectsWindow make_objects(const ObjectsOptions& options) {
  return ObjectsMaker(options).make();
}

}  // namespace povslam::simulated
