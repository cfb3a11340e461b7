// Local bundle adjustment: keyframe poses and landmarks that fit all their observations best (robust least squares).
// Ceres' door. Residuals are whitened and under Huber losses, pixel and depth of an observation apart: judged together,
// a wrong depth (an edge, a badly registered camera) would take a good pixel with it. A second round leaves out what
// did not fit the first. Deterministic: one thread, limits are counts, never clocks.
#pragma once

#include "pipeline/frontend/smooth_problem.hpp"

namespace povslam {

struct SmoothOptions {
  int max_iterations = 10;           // of each round
  double huber_pixel = 2.15;         // whitened norm (2 dof, 90 %) beyond which the loss is linear
  double huber_depth = 1.64;         // the same of the depth (1 dof)
  double outlier_chi2_pixel = 9.21;  // whitened squared norm (2 dof, 99 %) beyond which an observation is an outlier
  double outlier_chi2_depth = 6.63;  // the same of the depth (1 dof): beyond it only the pixel takes part
  int num_threads = 1;
};

// Solves in place: non-fixed poses and all points move, observations are marked, the answer fields filled.
// Stays as it was: a free pose whose observations leave a direction undetermined, a point with fewer residuals than
// unknowns, and a point whose answer is behind its cameras, ran away or has no observation left that fits.
// converged = true: the answer may be used (the cost stopped falling, or the iterations ran out with a lower one).
// A problem with numbers that are none, without a fixed pose, with nothing to move, numerically degenerate or of which
// less than half fits afterwards comes back unchanged, converged = false.
void smooth(SmoothProblem& problem, const SmoothOptions& options);

}  // namespace povslam
