#include "pipeline/objects/state.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/base/expects.hpp"

namespace povslam {
namespace {

// Both weights in logarithms: far from the mean the normal density underflows long before it stops mattering.
struct Mixture {
  double c1 = 0.0, evidence = 0.0;
};

Mixture mixture(double log_eta1_n, double log_eta2_u) {
  const double top = std::max(log_eta1_n, log_eta2_u);
  const double sum = std::exp(log_eta1_n - top) + std::exp(log_eta2_u - top);
  return {std::exp(log_eta1_n - top) / sum, std::exp(top) * sum};
}

double log_gamma_ratio(double a, double b, double A, double B) {  // of ln B(A, B) / B(a, b)
  return std::lgamma(A) + std::lgamma(B) - std::lgamma(A + B) - std::lgamma(a) - std::lgamma(b) + std::lgamma(a + b);
}

}  // namespace

BeliefUpdate update(const Belief& q, const ChangeMeasurement& z) {
  EXPECTS(q.sigma2 > 0.0 && q.alpha > 0.0 && q.beta > 0.0 && z.tau2 > 0.0 && z.max_change_m > 0.0 && z.k >= 0.0);
  const double delta = std::clamp(z.change_m, -z.max_change_m, z.max_change_m);  // beyond it U = 0 would say inlier
  const double A = q.alpha + (z.stationary ? z.k : 0.0);
  const double B = q.beta + (z.stationary ? 0.0 : z.k);
  const double S = A + B;
  const double gamma2 = 1.0 / (1.0 / q.sigma2 + 1.0 / z.tau2);
  const double m = gamma2 * (q.mu / q.sigma2 + delta / z.tau2);
  const double variance = q.sigma2 + z.tau2;
  const double log_n =
      -0.5 * (std::log(2.0 * std::numbers::pi * variance) + (delta - q.mu) * (delta - q.mu) / variance);
  const double log_u = -std::log(2.0 * z.max_change_m);
  const double log_class =
      z.k == 0.0 ? 0.0 : log_gamma_ratio(q.alpha, q.beta, A, B);  // eta1 = e^this A / S, eta2 B / S
  const Mixture mix = mixture(log_class + std::log(A / S) + log_n, log_class + std::log(B / S) + log_u);
  const double c1 = mix.c1, c2 = 1.0 - mix.c1;

  BeliefUpdate out;
  out.inlier = c1;
  out.evidence = mix.evidence;
  Belief& p = out.belief;
  p.mu = c1 * m + c2 * q.mu;
  // Central moments: second moments minus the squared mean would cancel for far means.
  p.sigma2 = c1 * (gamma2 + (m - p.mu) * (m - p.mu)) + c2 * (q.sigma2 + (q.mu - p.mu) * (q.mu - p.mu));
  const double theta = (A + c1) / (S + 1.0);
  const double m2 = (c1 * (A + 1.0) * (A + 2.0) + c2 * A * (A + 1.0)) / ((S + 1.0) * (S + 2.0));
  const double spread = m2 - theta * theta;
  const double count = spread < 1e-12 ? q.alpha + q.beta : (theta - m2) / spread;
  p.alpha = theta * count;
  p.beta = (1.0 - theta) * count;
  return out;
}

BeliefUpdate observe_change(const Belief& belief, double change_m, const ObjectClass& object_class,
                            const BeliefOptions& options) {
  ChangeMeasurement z{change_m, options.tau_m * options.tau_m, options.max_change_m, is_stationary(object_class.kind),
                      0.0};
  const bool inlier = update(belief, z).inlier >= 0.5;
  z.k = inlier ? object_class.k_inlier : object_class.k_outlier;
  BeliefUpdate out = update(belief, z);
  const double scale = std::min(1.0, options.max_count / std::max(out.belief.alpha, out.belief.beta));
  out.belief.alpha *= scale;
  out.belief.beta *= scale;
  return out;
}

Belief initial_belief(const ObjectClass& object_class, const BeliefOptions& options) {
  return {0.0, options.sigma_m * options.sigma_m, object_class.prior_alpha, object_class.prior_beta};
}

double clamped_consistency(const Belief& belief) {
  return std::clamp(belief.expected_consistency(), 1e-4, 0.9999);
}

}  // namespace povslam
