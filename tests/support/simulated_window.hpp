// A window of keyframes past a wall of clutter with a known truth: what smooth() is asked in tests and benchmarks.
// The camera drives along x looking towards y at points 1 to 6 m away; keyframes are 0.15 m apart and turn a little.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "pipeline/frontend/smooth_problem.hpp"

namespace povslam::simulated {

struct WindowOptions {
  int num_fixed = 16, num_free = 16, num_points = 4000, max_observations = 25'000;
  double pixel_sigma_px = 0.8, inverse_depth_sigma_per_m = 0.0025;
  double share_without_depth = 0.2;                                         // of observations
  double share_outliers = 0.0;                                              // of observations: pixel and depth anywhere
  double pose_error_m = 0.02, pose_error_rad = 0.01, point_error_m = 0.05;  // of the first guess
  unsigned seed = 1;
};

struct Window {
  SmoothProblem problem;                // perturbed
  std::vector<Rigid3> poses;            // truth
  std::vector<Eigen::Vector3d> points;  // truth
  std::vector<bool> planted;            // per observation: a planted outlier
};

class Maker {
 public:
  explicit Maker(const WindowOptions& options) : options_(options), random_(options.seed) {}

  Window make() {
    auto& problem = window_.problem;
    problem.fx = problem.fy = 525.0;
    problem.cx = 319.5;
    problem.cy = 239.5;
    add_poses();
    add_points();
    add_observations();
    return std::move(window_);
  }

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double normal(double sigma) { return sigma * std::normal_distribution<double>()(random_); }
  Eigen::Vector3d normal3(double sigma) {
    const double x = normal(sigma), y = normal(sigma), z = normal(sigma);
    return {x, y, z};
  }

  int num_poses() const { return options_.num_fixed + options_.num_free; }

  void add_poses() {
    Eigen::Matrix3d R_world_camera;  // camera z along world y, camera y down
    R_world_camera << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    for (int i = 0; i < num_poses(); ++i) {
      Rigid3 truth{Eigen::Quaterniond(R_world_camera), {0.15 * i, 0.1 * std::sin(0.5 * i), 1.0}};
      truth.rotation =
          (so3_exp({0.05 * std::sin(0.9 * i), 0.0, 0.2 * std::sin(0.3 * i)}) * truth.rotation).normalized();
      const bool fixed = i < options_.num_fixed;
      Vector6d xi;
      xi << normal3(options_.pose_error_m), normal3(options_.pose_error_rad);
      window_.poses.push_back(truth);
      window_.problem.poses.push_back({fixed ? truth : retract(truth, xi), i, fixed});
    }
  }

  void add_points() {
    for (int i = 0; i < options_.num_points; ++i) {
      const double x = uniform(0.0, 0.15 * num_poses()), y = uniform(1.5, 6.0), z = uniform(0.4, 1.6);
      window_.points.emplace_back(x, y, z);
      window_.problem.points.push_back({window_.points.back() + normal3(options_.point_error_m), i, 0});
    }
  }

  void add_observations() {
    std::vector<SmoothProblem::Observation> all;
    for (int point = 0; point < options_.num_points; ++point) {
      for (int pose = 0; pose < num_poses(); ++pose) {
        const Eigen::Vector3d p = window_.poses[pose].inverse() * window_.points[point];
        const double u = 525.0 * p.x() / p.z() + 319.5, v = 525.0 * p.y() / p.z() + 239.5;
        if (p.z() > 0.3 && u > 0 && v > 0 && u < 639 && v < 479) all.push_back(observe(pose, point, u, v, p.z()));
      }
    }
    // A feature is not found again in every keyframe that could see it.
    const double keep = std::min(1.0, options_.max_observations / static_cast<double>(all.size()));
    for (const auto& seen : all) {
      if (uniform(0.0, 1.0) > keep) continue;
      window_.problem.observations.push_back(seen);
      window_.planted.push_back(uniform(0.0, 1.0) < options_.share_outliers);
      if (window_.planted.back()) spoil(window_.problem.observations.back());
    }
  }

  SmoothProblem::Observation observe(int pose, int point, double u, double v, double z) {
    const double sigma_px = options_.pixel_sigma_px * std::pow(1.2, std::floor(uniform(0.0, 4.0)));
    SmoothProblem::Observation seen;
    seen.pose = pose;
    seen.point = point;
    seen.u_px = static_cast<float>(u + normal(sigma_px));
    seen.v_px = static_cast<float>(v + normal(sigma_px));
    seen.sigma_px = static_cast<float>(sigma_px);
    seen.sigma_inverse_depth_per_m = static_cast<float>(options_.inverse_depth_sigma_per_m);
    const double inverse_depth = 1.0 / z + normal(options_.inverse_depth_sigma_per_m);
    if (uniform(0.0, 1.0) >= options_.share_without_depth) seen.inverse_depth_per_m = static_cast<float>(inverse_depth);
    return seen;
  }

  void spoil(SmoothProblem::Observation& seen) {
    const double angle = uniform(0.0, 6.28), far_px = uniform(15.0, 60.0);
    seen.u_px += static_cast<float>(far_px * std::cos(angle));
    seen.v_px += static_cast<float>(far_px * std::sin(angle));
    if (seen.inverse_depth_per_m > 0.0F) seen.inverse_depth_per_m = static_cast<float>(uniform(0.1, 1.0));
  }

  WindowOptions options_;
  std::mt19937_64 random_;
  Window window_;
};

inline Window make_window(const WindowOptions& options) {
  return Maker(options).make();
}

// A few keyframes, every point seen whenever it is in view: for tests of single effects.
inline WindowOptions small_window() {
  WindowOptions options;
  options.num_fixed = 3;
  options.num_free = 4;
  options.num_points = 60;
  options.max_observations = 100'000;  // everything in view is seen
  return options;
}

// RMS over the free poses of the translation's and the rotation's error.
inline Eigen::Vector2d pose_error(const Window& window, const SmoothProblem& problem) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    if (problem.poses[i].fixed) continue;
    const Vector6d xi = local(window.poses[i], problem.poses[i].T_world_camera);
    sum += Eigen::Vector2d(xi.head<3>().squaredNorm(), xi.tail<3>().squaredNorm());
    ++count;
  }
  return (sum / count).cwiseSqrt();
}

inline double median_point_error(const Window& window, const SmoothProblem& problem) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    errors.push_back((problem.points[i].p_world - window.points[i]).norm());
  }
  std::ranges::nth_element(errors, errors.begin() + errors.size() / 2);
  return errors[errors.size() / 2];
}

}  // namespace povslam::simulated
