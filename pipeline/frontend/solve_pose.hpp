// Camera pose from landmarks at known places: robust Gauss-Newton on pixel and inverse-depth residuals.
//   r_px = ((u_hat - u), (v_hat - v)) / sigma_px,   r_d = (1/z_hat - 1/z) / sigma_inverse_depth
// Pixel and depth of one feature are judged apart: a corner on an edge often has a good pixel and a wrong depth.
#pragma once

#include <span>

#include "pipeline/geometry/camera.hpp"
#include "pipeline/geometry/rigid.hpp"

namespace povslam {

struct PoseObservation {
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();
  double u_px = 0.0, v_px = 0.0;      // rectified
  double inverse_depth_per_m = 0.0;   // 0 = none
  double weight_px = 1.0;             // 1 / sigma^2 [1/px^2]
  double weight_inverse_depth = 0.0;  // 1 / sigma^2 [m^2]
  double trust = 1.0;                 // factor on both in the solution, not in what fits
  bool fits = true;                   // answer: the pixel agrees
  bool depth_fits = true;             // answer: there is a depth and it agrees
};

struct PoseSolution {
  Rigid3 T_camera_world;
  Matrix6d information = Matrix6d::Zero();  // of xi in T_camera_world <- Exp(xi) T_camera_world
  int num_inliers = 0;
  int num_depth_inliers = 0;
  double chi2_per_dof = 0.0;  // of the inliers; near 1 when the noise model is right
  bool converged = false;
};

struct PoseSolverOptions {
  int rounds = 4;             // each: iterate, then decide again what fits
  int iterations = 6;         // at most, per round
  double chi2_pixel = 5.991;  // 2 dof, 95 %
  double chi2_depth = 6.635;  // 1 dof, 99 %
  double first_gate = 1.0;    // factor on both limits in the first round: wider for a poor start
};

PoseSolution solve_pose(const PinholeCamera& camera, const Rigid3& T_camera_world_start,
                        std::span<PoseObservation> observations, const PoseSolverOptions& options);

}  // namespace povslam
