// Worked numbers: closed form, cross-checked by brute-force integration over (l, v).
#include "pipeline/objects/state.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <ostream>

namespace povslam {
namespace {

struct Worked {
  const char* name;
  Belief before;
  ChangeMeasurement z;
  double inlier, evidence, mu, sigma2, alpha, beta, consistency;
};
std::ostream& operator<<(std::ostream& out, const Worked& worked) {
  return out << worked.name;
}

class WorkedExample : public testing::TestWithParam<Worked> {};

TEST_P(WorkedExample, IsUpdatedExactly) {
  const Worked& w = GetParam();
  const BeliefUpdate got = update(w.before, w.z);
  EXPECT_NEAR(got.inlier, w.inlier, 2e-12);
  EXPECT_NEAR(got.evidence, w.evidence, 1e-11);
  EXPECT_NEAR(got.belief.mu, w.mu, 2e-11);
  EXPECT_NEAR(got.belief.sigma2, w.sigma2, 4e-11);
  EXPECT_NEAR(got.belief.alpha, w.alpha, 3e-11);
  EXPECT_NEAR(got.belief.beta, w.beta, 3e-11);
  EXPECT_NEAR(got.belief.expected_consistency(), w.consistency, 2e-12);
}

INSTANTIATE_TEST_SUITE_P(Belief, WorkedExample,
                         testing::Values(Worked{"SmallChange",
                                                {0, 0.25, 2, 1},
                                                {0.05, 0.04, 4, false, 0},
                                                0.921887782189,
                                                0.533420607357,
                                                0.039736542336,
                                                0.051451077522,
                                                2.615900229819,
                                                0.965209552377,
                                                0.730471945547},
                                         Worked{"DoubtfulChange",
                                                {0, 0.25, 2, 1},
                                                {1.2, 0.04, 4, false, 0},
                                                0.497457208508,
                                                0.082911679109,
                                                0.514610905354,
                                                0.410321119796,
                                                1.840595788616,
                                                1.107355883741,
                                                0.624364302127},
                                         Worked{"GoneAndProneToGo",
                                                {0, 0.25, 2, 1},
                                                {4.0, 0.04, 4, false, 3},
                                                3e-12,
                                                0.008333333333,
                                                1.1e-11,
                                                0.250000000036,
                                                2.0,
                                                5.0,
                                                0.285714285715},
                                         Worked{"ThereAndWontToStay",
                                                {0, 0.25, 2, 1},
                                                {0.05, 0.04, 4, true, 3},
                                                0.967218742857,
                                                0.254210303679,
                                                0.041690463054,
                                                0.041606592737,
                                                5.730154289481,
                                                0.991751133273,
                                                0.852459820408},
                                         Worked{"SettledThenChanged",
                                                {0.05, 0.01, 9, 1.5},
                                                {0.8, 0.04, 4, false, 3},
                                                0.093342970722,
                                                0.000399620616,
                                                0.064001445608,
                                                0.011717490421,
                                                8.856630729775,
                                                5.265914300718,
                                                0.627127101429}),
                         testing::PrintToStringParamName());

// Moments of the true posterior, summed over a grid.
TEST(Belief, HasTheMomentsOfTheTruePosterior) {
  const Belief q{0.1, 0.09, 3.0, 1.7};
  const ChangeMeasurement z{0.45, 0.02, 2.0, false, 2.0};
  double mass = 0, l1 = 0, l2 = 0, v1 = 0, v2 = 0;
  constexpr int kSteps = 1200;
  for (int i = 0; i < kSteps; ++i) {
    const double l = -2.5 + 5.0 * (i + 0.5) / kSteps;
    const auto normal = [](double d, double s2) {
      return std::exp(-0.5 * d * d / s2) / std::sqrt(2 * std::numbers::pi * s2);
    };
    for (int j = 0; j < kSteps; ++j) {
      const double v = (j + 0.5) / kSteps;
      const double likelihood = v * normal(z.change_m - l, z.tau2) + (1 - v) / (2 * z.max_change_m);
      const double p = normal(l - q.mu, q.sigma2) * std::pow(v, q.alpha - 1) * std::pow(1 - v, q.beta - 1) *
                       likelihood * std::pow(1 - v, z.k);
      mass += p, l1 += p * l, l2 += p * l * l, v1 += p * v, v2 += p * v * v;
    }
  }
  const Belief got = update(q, z).belief;
  EXPECT_NEAR(got.mu, l1 / mass, 1e-5);
  EXPECT_NEAR(got.sigma2 + got.mu * got.mu, l2 / mass, 1e-5);
  EXPECT_NEAR(got.expected_consistency(), v1 / mass, 1e-5);
  const double s = got.alpha + got.beta;
  EXPECT_NEAR(got.alpha * (got.alpha + 1) / (s * (s + 1)), v2 / mass, 1e-5);
}

BeliefOptions pocd() {
  BeliefOptions options;
  options.sigma_m = 0.5;
  options.tau_m = 0.2;
  return options;
}

struct Life {
  Life(ClassKind kind) : object_class(make_class(1, "thing", kind)), belief(initial_belief(object_class, pocd())) {}
  double see(double change_m) {
    belief = observe_change(belief, change_m, object_class, pocd()).belief;
    return belief.expected_consistency();
  }
  ObjectClass object_class;
  Belief belief;
};

TEST(Belief, OfAThingProneToMoveRisesSlowlyAndFallsBelowTheThresholdAtTheThirdMiss) {
  Life life(ClassKind::semi_static);
  for (const double expected : {0.730472, 0.781929, 0.818613, 0.845315, 0.865428}) {
    EXPECT_NEAR(life.see(0.05), expected, 1e-6);
  }
  EXPECT_NEAR(life.belief.alpha, 6.000749, 1e-6);
  EXPECT_NEAR(life.belief.beta, 0.933105, 1e-6);
  EXPECT_NEAR(life.belief.mu, 0.048277, 1e-6);
  EXPECT_NEAR(std::sqrt(life.belief.sigma2), 0.092934, 1e-6);
  for (const double expected : {0.548823, 0.401822, 0.316932}) EXPECT_NEAR(life.see(4.0), expected, 1e-6);
  EXPECT_LT(life.belief.expected_consistency(), pocd().remove_below);
}

TEST(Belief, OfAThingWontToStayRisesFastAndOutlivesTenMisses) {
  Life life(ClassKind::static_object);
  for (const double expected : {0.852460, 0.906563, 0.931759, 0.950011, 0.963581}) {
    EXPECT_NEAR(life.see(0.05), expected, 1e-6);
  }
  for (const double expected : {0.878893, 0.807888, 0.747498}) EXPECT_NEAR(life.see(4.0), expected, 1e-6);
  for (int i = 3; i < 10; ++i) life.see(4.0);
  EXPECT_NEAR(life.belief.expected_consistency(), 0.490726, 1e-6);
}

TEST(Belief, InANewThingGoesWithTheFirstMissOrTheThird) {
  Life mobile(ClassKind::semi_static);
  EXPECT_NEAR(mobile.see(4.0), 2.0 / 7.0, 1e-9);
  Life settled(ClassKind::static_object);
  EXPECT_NEAR(settled.see(4.0), 0.5, 1e-9);
  EXPECT_NEAR(settled.see(4.0), 0.4, 1e-9);
  EXPECT_NEAR(settled.see(4.0), 1.0 / 3.0, 1e-9);
}

TEST(Belief, TakesAnAbsurdMeasurementAsAnOutlier) {
  const BeliefUpdate got = update({0, 0.25, 2, 1}, {1e6, 0.04, 4, false, 0});
  EXPECT_LT(got.inlier, 1e-9);
  EXPECT_NEAR(got.belief.beta, 2.0, 1e-9);
}

TEST(Belief, NeverBecomesSoSureThatItCannotTurn) {
  Life life(ClassKind::static_object);
  for (int i = 0; i < 1000; ++i) life.see(0.01);
  EXPECT_LE(life.belief.alpha, 10.0 + 1e-9);
  EXPECT_LE(clamped_consistency(life.belief), 0.9999);
  int misses = 0;
  while (life.see(4.0) >= pocd().remove_below && misses < 100) ++misses;
  EXPECT_LT(misses, 25);
}

}  // namespace
}  // namespace povslam
