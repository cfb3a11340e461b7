#include "pipeline/backend/expect.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <random>

#include "pipeline/backend/kernels/dispatch.hpp"
#include "pipeline/backend/maximise.hpp"
#include "tests/support/simulated_objects.hpp"

namespace povslam {

namespace {

constexpr double kSigma = 0.05;

double bias(int dimension, double sigma, double e_max, VemUniform measure = VemUniform::norm) {
  return log_gaussian_peak(dimension, sigma * sigma) - log_uniform(dimension, e_max, measure);
}

double responsibility_at(double alpha, double beta, double error) {
  return responsibility(expected_logs(alpha, beta).odds(), bias(3, kSigma, 1.0), error * error, kSigma * kSigma);
}

double bound_at(double alpha, double beta, double error) {
  const double log_gaussian = log_gaussian_peak(3, kSigma * kSigma) - 0.5 * error * error / (kSigma * kSigma);
  return match_bound(expected_logs(alpha, beta), log_gaussian, log_uniform(3, 1.0, VemUniform::norm));
}

// One object of four landmarks whose residuals in the one frame are as given.
VemWindow one_object(const std::array<double, 4>& errors_m) {
  VemWindow window;
  window.poses = {Rigid3{}};
  window.prior.T_world_camera = window.poses[0];
  VemObject object;
  object.belief = {0.0, 0.01, 2.0, 1.0};
  object.num_landmarks = 4;
  window.objects.push_back(object);
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d p(i, 0.5 * i * i, 1.0);
    window.landmarks.push_back({p, p, p});
    const double error_m = errors_m[static_cast<std::size_t>(i)];
    window.matches.push_back({0, i, p + Eigen::Vector3d(0.0, error_m, 0.0), kSigma});
  }
  return window;
}

// An E-step of a window as it stands.
struct Step {
  WindowSheet sheet;
  VemEstimate estimate;
  Expectation expectation;

  Step(const VemWindow& window, const VemOptions& options) {
    sheet.assign(window, options);
    estimate = sheet.initial(window);
    measure_errors(sheet, estimate);
    expectation.start(window, sheet, options);
    expectation.run(sheet, estimate.error2, false);
  }
};

VemOptions options_with_unit_ball() {
  VemOptions options;
  options.e_max_m = 1.0;
  options.em_state = VemState::held;
  return options;
}

double evidence_at(double expected_v, double error) {
  const double log_gaussian = log_gaussian_peak(3, kSigma * kSigma) - 0.5 * error * error / (kSigma * kSigma);
  return std::log(expected_v * std::exp(log_gaussian) + (1.0 - expected_v));
}

}  // namespace

TEST(Expect, MatchesTheWorkedNumbers) {
  struct Row {
    double alpha, beta, exp_log_v, exp_log_not_v, pi[3], bound[3], evidence;
  };
  const Row rows[] = {{1,
                       1,
                       0.367879,
                       0.367879,
                       {0.996764662, 0.849461176, 0.145589744},
                       {4.733621804, 0.893534262, -0.842656193},
                       1.200387081},
                      {2,
                       1,
                       0.606531,
                       0.223130,
                       {0.998807346, 0.938795745, 0.316561578},
                       {5.231574586, 1.293538568, -1.119381281},
                       1.409816314},
                      {5,
                       1,
                       0.818731,
                       0.101944,
                       {0.999596009, 0.978410338, 0.577791682},
                       {5.530785293, 1.552207350, -1.421076892},
                       1.582889374},
                      {1,
                       4,
                       0.124514,
                       0.778801,
                       {0.980102204, 0.474284681, 0.026520671},
                       {3.667146311, 0.392995432, -0.223121312},
                       0.656774093}};
  const double errors[] = {0.05, 0.15, 0.20};
  for (const Row& row : rows) {
    const ConsistencyLogs logs = expected_logs(row.alpha, row.beta);
    EXPECT_NEAR(std::exp(logs.log_v), row.exp_log_v, 1e-6);
    EXPECT_NEAR(std::exp(logs.log_not_v), row.exp_log_not_v, 1e-6);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(responsibility_at(row.alpha, row.beta, errors[k]), row.pi[k], 1e-9);
      EXPECT_NEAR(bound_at(row.alpha, row.beta, errors[k]), row.bound[k], 1e-8);
    }
    EXPECT_NEAR(evidence_at(row.alpha / (row.alpha + row.beta), 0.15), row.evidence, 1e-8);
    EXPECT_LT(bound_at(row.alpha, row.beta, 0.15), row.evidence);  // it is a bound
  }
}

TEST(Expect, GateRadiiMatchTheWorkedNumbers) {
  const double consistencies[] = {0.1, 0.5, 0.9, 0.99};
  struct Row {
    double sigma, e_max, radius[4];
  };
  const Row rows[] = {{0.02, 1, {0.0737, 0.0848, 0.0946, 0.1042}},
                      {0.05, 1, {0.1420, 0.1765, 0.2053, 0.2327}},
                      {0.05, 4, {0.1646, 0.1951, 0.2215, 0.2471}},
                      {0.1, 4, {0.2585, 0.3328, 0.3933, 0.4502}}};
  for (const Row& row : rows) {
    for (int k = 0; k < 4; ++k) {
      EXPECT_NEAR(gate_radius(consistencies[k], row.sigma, bias(3, row.sigma, row.e_max)), row.radius[k], 5e-5);
    }
  }
  EXPECT_NEAR(gate_radius(0.5, 0.1, bias(2, 0.1, 4.0)), 0.2882, 5e-5);
  EXPECT_NEAR(gate_radius(0.5, 0.05, bias(3, 0.05, 4.0, VemUniform::ball)), 0.243, 5e-4);
  EXPECT_EQ(gate_radius(0.001, 2.0, bias(3, 2.0, 1.0)), 0.0);
}

TEST(Expect, AnObjectsMatchesShareItsConsistency) {
  const VemWindow window = one_object({0.02, 0.03, 0.05, 0.30});
  const Step held(window, options_with_unit_ball());
  const double pi[] = {0.999216050, 0.999133673, 0.998807346, 0.000021028};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(held.expectation.responsibilities()[0].lane[i], pi[i], 1e-9);
  EXPECT_NEAR(held.expectation.bound(), 14.934009017, 1e-8);

  VemOptions mean_field = options_with_unit_ball();
  mean_field.mean_field = true;
  const Step whole(window, mean_field);
  const double fixed_pi[] = {0.999277062, 0.999201091, 0.998900132, 0.000022804};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(whole.expectation.responsibilities()[0].lane[i], fixed_pi[i], 1e-8);
  EXPECT_NEAR(whole.expectation.bound(), 15.225736244, 1e-7);
  EXPECT_NEAR(whole.expectation.expected_v(0), 4.997401090 / (4.997401090 + 2.002598910), 1e-8);
}

TEST(Expect, TheDivergenceOfBetasIsZeroOnlyForTheSame) {
  EXPECT_NEAR(kl_beta(3.0, 2.0, 3.0, 2.0), 0.0, 1e-12);
  EXPECT_GT(kl_beta(3.0, 2.0, 2.0, 2.0), 0.01);
}

TEST(Expect, TheVectorKernelComputesTheFormulas) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> error(0.0, 1.5), sigma(0.02, 0.3), odds(-8.0, 8.0);
  constexpr int kCount = 600;
  constexpr double kMost = 900.0;  // sigmas below 1/30 m count as that
  std::vector<Quad> error2(kCount), inverse(kCount), bias_of(kCount), pi(kCount), information(kCount);
  for (int i = 0; i < 4 * kCount; ++i) {
    const std::size_t slot = static_cast<std::size_t>(i / 4);
    const double e = error(random), s = i % 7 == 0 ? 0.0 : sigma(random);
    error2[slot].lane[i % 4] = e * e;
    inverse[slot].lane[i % 4] = s == 0.0 ? 0.0 : 1.0 / (s * s);
    bias_of[slot].lane[i % 4] = s == 0.0 ? 0.0 : bias(3, s, 4.0);
  }
  for (int isa = 0; isa <= widest_isa(); ++isa) {
    VemExpect sums{odds(random), 0.0, 0.0};
    const VemNoise noise{kCount, inverse.data(), bias_of.data(), kMost, bias(3, 1.0 / std::sqrt(kMost), 4.0)};
    vem_kernels(isa).expect(&noise, error2.data(), &sums, pi.data());
    const VemDecision decision = vem_kernels(isa).gate(&noise, sums.odds, error2.data(), pi.data(), information.data());
    double sum = 0.0, excess = 0.0;
    int accepted = 0;
    for (int i = 0; i < 4 * kCount; ++i) {
      const std::size_t slot = static_cast<std::size_t>(i / 4);
      const double iv = std::min(inverse[slot].lane[i % 4], kMost), e2 = error2[slot].lane[i % 4];
      const double b = iv == kMost ? noise.its_bias : bias_of[slot].lane[i % 4];
      const double p = iv == 0.0 ? 0.0 : responsibility(sums.odds, b, e2, 1.0 / iv);
      const double logit = sums.odds + b - 0.5 * e2 * iv;
      EXPECT_NEAR(pi[slot].lane[i % 4], p, 1e-14 + 1e-13 * p);
      EXPECT_EQ(information[slot].lane[i % 4], logit >= 0.0 ? pi[slot].lane[i % 4] * iv : 0.0);
      sum += p;
      excess += iv == 0.0 ? 0.0 : match_bound({sums.odds, 0.0}, b - 0.5 * e2 * iv, 0.0);
      accepted += information[slot].lane[i % 4] > 0.0 ? 1 : 0;
    }
    EXPECT_NEAR(sums.sum_pi, sum, 1e-9);
    EXPECT_NEAR(sums.sum_excess, excess, 1e-8);
    EXPECT_EQ(decision.accepted, accepted);
    std::ranges::fill(information, Quad{});
  }
}

TEST(Expect, CarriesTheBetaButNotTheGaussian) {
  const VemWindow window = one_object({0.01, 0.02, 0.01, 0.02});
  Step step(window, VemOptions{});
  const double once = step.expectation.expected_v(0);
  for (int i = 0; i < 50; ++i) step.expectation.run(step.sheet, step.estimate.error2, false);
  EXPECT_GT(step.expectation.expected_v(0), once);
  EXPECT_GT(step.expectation.expected_v(0), 0.95);
  EXPECT_EQ(step.expectation.belief(0).mu, 0.0);
  EXPECT_EQ(step.expectation.belief(0).sigma2, 0.01);

  VemOptions anew;
  anew.em_state = VemState::none;
  Step from_stored(window, anew);
  for (int i = 0; i < 50; ++i) from_stored.expectation.run(from_stored.sheet, from_stored.estimate.error2, false);
  EXPECT_EQ(from_stored.expectation.expected_v(0), once);
}

TEST(Expect, AMovedObjectsGaussianLocksOnWhenItIsCarried) {  // why it is not, by default
  VemWindow window = one_object({0.5, 0.5, 0.5, 0.5});
  window.objects[0].belief.sigma2 = 0.25;
  window.objects[0].k_outlier = 0.0;
  VemOptions full, beta;
  full.em_state = VemState::full;
  full.belief.tau_m = beta.belief.tau_m = 0.2;
  Step locks(window, full), carries(window, beta);
  for (int i = 0; i < 100; ++i) {
    locks.expectation.run(locks.sheet, locks.estimate.error2, false);
    carries.expectation.run(carries.sheet, carries.estimate.error2, false);
  }
  EXPECT_GT(locks.expectation.belief(0).mu, 0.4);
  EXPECT_GT(locks.expectation.expected_v(0), 0.9);
  EXPECT_EQ(carries.expectation.belief(0).mu, 0.0);
}

TEST(Expect, StructureIsBelievedAsMuchAsAnythingEverIs) {
  VemWindow window = one_object({0.5, 0.5, 0.5, 0.5});
  window.objects[0].kind = ClassKind::structure;
  const Step step(window, VemOptions{});
  EXPECT_EQ(step.expectation.expected_v(0), kMaxConsistency);
  EXPECT_EQ(step.expectation.belief(0).alpha, window.objects[0].belief.alpha);
}

TEST(Expect, PoolsAnObjectsMatchesWhenAsked) {
  const VemWindow window = one_object({0.02, 0.03, 0.05, 0.30});
  VemOptions options = options_with_unit_ball();
  options.pool = VemPool::object;
  const Step step(window, options);
  std::vector<Quad> information(step.sheet.num_slots());
  const VemDecision decision = step.expectation.decide(step.sheet, step.estimate.error2, true, information);
  const Quad& pi = step.expectation.responsibilities()[0];
  for (int i = 1; i < 4; ++i) EXPECT_EQ(pi.lane[i], pi.lane[0]);
  EXPECT_TRUE(decision.accepted == 0 || decision.accepted == 4);
}

}  // namespace povslam
