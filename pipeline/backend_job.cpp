#include "pipeline/backend_job.hpp"

namespace povslam {

void solve(const BackendJob& job, const BackendOptions& options) {
  if (SmoothProblem* const* window = std::get_if<SmoothProblem*>(&job)) smooth(**window, options.smooth);
  if (LoopProblem* const* loop = std::get_if<LoopProblem*>(&job)) close_loop(**loop, options.close_loop);
  if (VemProblem* const* window = std::get_if<VemProblem*>(&job)) {
    VemOptions vem = options.vem;
    vem.belief = (*window)->belief;
    (*window)->result = Vem(vem).solve((*window)->window);
  }
}

}  // namespace povslam
