// Work the pipeline wants done beside tracking: whichever kind, solved in place by whoever runs the backend.
#pragma once

#include <variant>

#include "pipeline/frontend/loop_problem.hpp"
#include "pipeline/frontend/smooth_problem.hpp"
#include "pipeline/options.hpp"
#include "pipeline/vem_problem.hpp"

namespace povslam {

using BackendJob = std::variant<SmoothProblem*, LoopProblem*, VemProblem*>;  // never null; the pipeline's

void solve(const BackendJob& job, const BackendOptions& options);

}  // namespace povslam
