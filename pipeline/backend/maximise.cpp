#include "pipeline/backend/maximise.hpp"

#include "pipeline/backend/factors/pose_prior_factor.hpp"
#include "pipeline/backend/factors/vo_transition_factor.hpp"
#include "pipeline/backend/places.hpp"

namespace povslam {

std::unique_ptr<Maximiser> make_maximiser(VemSolver solver) {
  return solver == VemSolver::ceres ? make_ceres_maximiser() : make_structured_maximiser();
}

double measure_errors(const WindowSheet& sheet, VemEstimate& estimate) {
  Places places(estimate);
  double cost = 0.0;
  for (std::size_t object = 0; object < sheet.objects().size(); ++object) {
    const VemBlocks blocks = sheet.blocks(object, nullptr);
    cost += vem_kernels().measure(&blocks, &places.of(object), places.landmarks(sheet, object, estimate),
                                  estimate.error2.data() + sheet.first_slot(object));
  }
  return cost;
}

VemCost settle_landmarks(const WindowSheet& sheet, const std::vector<Quad>& information, VemEstimate& estimate) {
  Places places(estimate);
  VemCost cost{0.0, 0.0};
  for (std::size_t object = 0; object < sheet.objects().size(); ++object) {
    const VemBlocks blocks = sheet.blocks(object, information.data());
    const VemCost part = vem_kernels().settle(&blocks, &places.of(object), places.landmarks(sheet, object, estimate),
                                              estimate.error2.data() + sheet.first_slot(object));
    cost.matched += part.matched;
    cost.other += part.other;
  }
  return cost;
}

double motion_cost(const VemWindow& window, const std::vector<Rigid3>& poses) {
  const PosePriorError prior = pose_prior_error(window.prior, poses.front());
  double sum = inverse_sigmas(window.prior.sigma_m, window.prior.sigma_rad).cwiseProduct(prior.e).squaredNorm();
  for (std::size_t t = 0; t < window.transitions.size(); ++t) {
    const VemTransition& Z = window.transitions[t];
    const Vector6d e = vo_transition_error(Z, poses[t], poses[t + 1]).e;
    sum += inverse_sigmas(Z.sigma_m, Z.sigma_rad).cwiseProduct(e).squaredNorm();
  }
  return 0.5 * sum;
}

}  // namespace povslam
