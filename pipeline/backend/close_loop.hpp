// Closing a loop: keyframe poses that fit what tracking knew between neighbours and what was recognised, best
// (pose graph, robust least squares). Ceres' door. Two rounds: in the first all recognised places pull alike (Huber),
// in the second those that do not fit let go (Cauchy), so that one wrong among them shows and is refused.
// Deterministic unless limited by time; one thread.
#pragma once

#include "pipeline/frontend/loop_problem.hpp"

namespace povslam {

struct CloseLoopOptions {
  int max_iterations = 50;         // of each round
  double max_solve_s = 0.0;        // 0: no limit by time (replay); else a solution not found by then is none
  double loop_scale = 10.0;        // whitened residual norm beyond which a loop edge is believed less and less
  double max_loop_error_m = 0.10;  // of any loop edge after solving, else the answer is refused…
  double max_loop_error_rad = 0.05;
  double max_strain = 8.0;  // …and so it is when any other edge is bent more than this (whitened norm)
};

// Solves in place: non-fixed poses move. converged = true: the answer may be used. Otherwise the poses are unchanged:
// numbers that are none, an edge to itself or to a pose that is not there, nothing fixed, nothing to move, a pose that
// no edge joins to a fixed one, a loop that does not fit its neighbours, time over. Never throws, never aborts.
// What a refused answer came to stands in loop_error_* and strain; cost_after is that of the poses as they are.
void close_loop(LoopProblem& problem, const CloseLoopOptions& options);

}  // namespace povslam
