// Local bundle adjustment: keyframe poses and landmarks that fit all their observations best (robust least squares).
// Ceres' door. Residuals are whitened and under a Huber loss; a second round leaves out what did not fit the first.
// Deterministic: one thread, limits are counts, never clocks.
#pragma once

#include "pipeline/frontend/smooth_problem.hpp"

namespace povslam {

struct SmoothOptions {
  int max_iterations = 10;              // of each round
  double huber_threshold = 2.45;        // whitened residual norm (3 dof, 90 %) beyond which the loss is linear
  double outlier_chi2 = 11.35;          // whitened squared norm (3 dof, 99 %) beyond which an observation is an outlier
  double outlier_chi2_no_depth = 9.21;  // the same for one without depth (2 dof, 99 %)
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
