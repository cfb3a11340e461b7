#include "pipeline/backend_job.hpp"

#include <algorithm>
#include <cmath>

namespace povslam {

void solve(const BackendJob& job, const BackendOptions& options) {
  if (SmoothProblem* const* window = std::get_if<SmoothProblem*>(&job)) smooth(**window, options.smooth);
  if (LoopProblem* const* loop = std::get_if<LoopProblem*>(&job)) close_loop(**loop, options.close_loop);
  if (VemProblem* const* window = std::get_if<VemProblem*>(&job)) {
    VemOptions vem = options.vem;
    vem.belief = (*window)->belief;
    // A frame's match counts as often as there are frames, where the map has the landmark only once: what moved would
    // take its landmarks along.
    const double share = 1.0 / std::sqrt(static_cast<double>(std::max<std::size_t>(1, (*window)->window.poses.size())));
    vem.sigma_prior_m *= share;
    vem.sigma_rigid_m *= share;
    (*window)->result = Vem(vem).solve((*window)->window);
  }
}

}  // namespace povslam
