// Rounds on a ring with a known truth, poses that drifted, and the places recognised again: what close_loop() is asked
// in tests and benchmarks. The camera looks along its way; pose i knows its predecessors, pose 0 is fixed.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "pipeline/frontend/loop_problem.hpp"

namespace povslam::simulated {

struct RingOptions {
  int num_poses = 200, poses_per_round = 180;
  int num_predecessors = 4;  // joined to each pose
  double step_m = 0.15;
  double sigma_m = 0.002, sigma_rad = 0.001;            // of an edge between neighbours
  double loop_sigma_m = 0.005, loop_sigma_rad = 0.003;  // of one to a place recognised
  int loop_every = 4;                                   // poses beyond the first round; 0: none
  unsigned seed = 1;
};

struct Ring {
  LoopProblem problem;        // drifted
  std::vector<Rigid3> truth;  // by pose
};

namespace detail {

inline Rigid3 noisy(const Rigid3& T, double sigma_m, double sigma_rad, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Vector6d xi;
  for (int k = 0; k < 6; ++k) xi[k] = (k < 3 ? sigma_m : sigma_rad) * normal(random);
  return retract(T, xi);
}

inline Rigid3 place_on_ring(int i, const RingOptions& options) {
  const double angle = 2.0 * std::numbers::pi * i / options.poses_per_round;
  const double radius_m = options.step_m * options.poses_per_round / (2.0 * std::numbers::pi);
  Eigen::Matrix3d R;  // camera z along the way, y down
  R.col(2) = Eigen::Vector3d(-std::sin(angle), std::cos(angle), 0.0);
  R.col(1) = -Eigen::Vector3d::UnitZ();
  R.col(0) = R.col(1).cross(R.col(2));
  const double wobble_m = 0.05 * std::sin(0.7 * i);
  return {Eigen::Quaterniond(R), {radius_m * std::cos(angle), radius_m * std::sin(angle), 1.0 + wobble_m}};
}

}  // namespace detail

inline Ring make_ring(const RingOptions& options) {
  Ring ring;
  std::mt19937 random(options.seed);
  LoopProblem& problem = ring.problem;
  const auto join = [&](int from, int to, bool loop) {
    const std::size_t a = static_cast<std::size_t>(from), b = static_cast<std::size_t>(to);
    LoopProblem::Edge edge;
    edge.from = from;
    edge.to = to;
    edge.sigma_m = loop ? options.loop_sigma_m : options.sigma_m;
    edge.sigma_rad = loop ? options.loop_sigma_rad : options.sigma_rad;
    edge.T_from_to = detail::noisy(ring.truth[a].inverse() * ring.truth[b], edge.sigma_m, edge.sigma_rad, random);
    edge.loop = loop;
    problem.edges.push_back(edge);
  };
  for (int i = 0; i < options.num_poses; ++i) {
    ring.truth.push_back(detail::place_on_ring(i, options));
    problem.poses.push_back({.T_world_camera = ring.truth.back(), .keyframe = i, .fixed = i == 0});
    for (int k = 1; k <= options.num_predecessors && k <= i; ++k) {
      join(i - k, i, false);
      if (k > 1) continue;  // the first guess hangs on the last pose alone: it drifts
      const auto& before = problem.poses[static_cast<std::size_t>(i - 1)];
      problem.poses.back().T_world_camera = before.T_world_camera * problem.edges.back().T_from_to;
    }
    const bool again = i >= options.poses_per_round && options.loop_every > 0 && i % options.loop_every == 0;
    if (again) join(i - options.poses_per_round, i, true);
  }
  return ring;
}

inline double worst_error_m(const Ring& ring, const LoopProblem& problem) {
  double worst = 0.0;
  for (std::size_t i = 0; i < ring.truth.size(); ++i) {
    const auto& T = problem.poses[i].T_world_camera;
    worst = std::max(worst, (T.translation - ring.truth[i].translation).norm());
  }
  return worst;
}

}  // namespace povslam::simulated
