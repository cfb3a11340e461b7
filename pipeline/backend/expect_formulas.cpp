// Method: the E-step's formulas in their numerically safe form. See docs/vem.md for the equations.
#include <algorithm>
#include <boost/math/special_functions/digamma.hpp>
#include <cmath>
#include <numbers>

#include "pipeline/backend/expect.hpp"

namespace povslam {

double log_gaussian_peak(int dimension, double variance) {
  return -0.5 * dimension * std::log(2.0 * std::numbers::pi * variance);
}

double log_uniform(int dimension, double e_max_m, VemUniform measure) {
  if (measure == VemUniform::norm) return -std::log(e_max_m);
  const double unit_ball = dimension == 2 ? std::numbers::pi : 4.0 / 3.0 * std::numbers::pi;
  return -std::log(unit_ball) - dimension * std::log(e_max_m);
}

ConsistencyLogs expected_logs(double alpha, double beta) {
  using boost::math::digamma;
  constexpr boost::math::policies::policy<boost::math::policies::promote_double<false>> kPlain;  // not as long double
  const double all = digamma(alpha + beta, kPlain);
  return {digamma(alpha, kPlain) - all, digamma(beta, kPlain) - all};
}

ConsistencyLogs logs_of_expected(const Belief& belief) {
  const double v = clamped_consistency(belief);
  return {std::log(v), std::log1p(-v)};
}

double responsibility(double odds, double bias, double error2, double variance) {
  const double logit = odds + bias - 0.5 * error2 / variance;
  const double t = std::exp(-std::abs(logit));
  return (logit > 0.0 ? 1.0 : t) / (1.0 + t);
}

double match_bound(const ConsistencyLogs& logs, double log_gaussian, double log_uniform) {
  const double a = logs.log_v + log_gaussian, b = logs.log_not_v + log_uniform;
  return std::max(a, b) + std::log1p(std::exp(-std::abs(a - b)));
}

double gate_radius(double expected_v, double sigma_m, double bias) {
  const double bracket = std::log(expected_v / (1.0 - expected_v)) + bias;
  return bracket > 0.0 ? sigma_m * std::sqrt(2.0 * bracket) : 0.0;
}

double kl_beta(double alpha, double beta, double prior_alpha, double prior_beta) {
  const auto log_beta = [](double a, double b) { return std::lgamma(a) + std::lgamma(b) - std::lgamma(a + b); };
  const ConsistencyLogs logs = expected_logs(alpha, beta);
  return log_beta(prior_alpha, prior_beta) - log_beta(alpha, beta) + (alpha - prior_alpha) * logs.log_v +
         (beta - prior_beta) * logs.log_not_v;
}

}  // namespace povslam
