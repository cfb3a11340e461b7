// A smooth problem as blocks a solver can move: what takes part, how well it fits, what the answer is worth.
#pragma once

#include <deque>
#include <vector>

#include "pipeline/backend/factors/depth_factor.hpp"
#include "pipeline/backend/factors/keypoint_factor.hpp"
#include "pipeline/backend/factors/pose_manifold.hpp"
#include "pipeline/backend/smooth.hpp"

namespace povslam {

// Finite numbers, unit rotations, indices inside, positive sigmas and focal lengths, at least one fixed pose.
bool valid(const SmoothProblem& problem);

// Lives for one smooth(): keeps a reference to the problem, whose poses and points it leaves alone until adopt().
class SmoothWindow {
 public:
  explicit SmoothWindow(const SmoothProblem& problem);  // of a valid problem; every observation takes part

  // Takes out observations whose pose or point the rest cannot hold: those of free poses with an undetermined
  // direction, then those of points with fewer residuals than unknowns, which say nothing about the poses.
  void leave_out_undetermined();
  // Lets exactly the observations whose pixel fits take part, and of their depths those that fit.
  void leave_out_outliers(const SmoothOptions& options);
  // Points that went astray go back to where they were.
  void restore_unbelievable_points();

  bool pixel_fits(std::size_t observation, const SmoothOptions& options) const;  // chi2 test, 2 dof
  bool depth_fits(std::size_t observation, const SmoothOptions& options) const;  // 1 dof; false without depth
  double robust_cost(const SmoothOptions& options) const;                        // over all observations
  bool finite() const;

  // In the order of the problem's arrays; they stay where they are in memory.
  std::vector<PoseBlock> poses;
  std::vector<Eigen::Vector3d> points;
  // One per observation (a Ceres cost function cannot be copied); the pixel's have two residuals each.
  std::deque<KeypointFactor> pixels;
  std::deque<DepthFactor> depths;
  std::vector<char> used;        // per observation: takes part in the next round
  std::vector<char> depth_used;  // and so does its depth; only where one was measured

 private:
  double chi2_pixel(std::size_t observation) const;
  double chi2_depth(std::size_t observation) const;
  std::vector<char> determined_poses() const;

  const SmoothProblem& problem_;
};

}  // namespace povslam
