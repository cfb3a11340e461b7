#include "pipeline/frontend/noise_scale.hpp"

#include <gtest/gtest.h>

#include <random>

namespace povslam {
namespace {

constexpr double kUpperQuartile = 1.1503;  // of the absolute value of a standard normal

// Frames whose residuals are `factor` times what the model says.
void learn(NoiseScale& scale, double factor, int frames, int samples, double share_outliers = 0.0) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0.0, factor);
  std::uniform_real_distribution<double> uniform;
  for (int f = 0; f < frames; ++f) {
    scale.start();
    for (int i = 0; i < samples; ++i) {
      scale.add(uniform(random) < share_outliers ? 1000.0 : std::abs(normal(random)));
    }
    scale.finish(kUpperQuartile);
  }
}

}  // namespace

TEST(NoiseScale, LearnsTheFactorWithinSomeFrames) {
  NoiseScale scale(1000);
  EXPECT_EQ(scale.value(), 1.0);
  learn(scale, 2.5, 60, 500);
  EXPECT_NEAR(scale.value(), 2.5, 0.15);
  learn(scale, 0.8, 80, 500);
  EXPECT_NEAR(scale.value(), 0.8, 0.06);
}

TEST(NoiseScale, IsNotMovedMuchByOneFrame) {
  NoiseScale scale(1000);
  learn(scale, 100.0, 1, 500);
  EXPECT_LT(scale.value(), 1.25);
}

TEST(NoiseScale, LearnsNothingFromFewSamples) {
  NoiseScale scale(1000);
  learn(scale, 3.0, 100, 39);
  EXPECT_EQ(scale.value(), 1.0);
}

TEST(NoiseScale, IsDeafToAFewOutliers) {
  NoiseScale scale(1000);
  learn(scale, 1.0, 60, 500, 0.1);
  EXPECT_NEAR(scale.value(), 1.0, 0.25);
}

TEST(NoiseScale, StaysWithinBounds) {
  NoiseScale loud(1000), quiet(1000);
  learn(loud, 1e6, 300, 100);
  learn(quiet, 0.0, 300, 100);
  EXPECT_NEAR(loud.value(), 8.0, 1e-6);
  EXPECT_NEAR(quiet.value(), 0.5, 1e-6);
}

TEST(NoiseScale, KeepsNoMoreSamplesThanItHasRoomFor) {
  NoiseScale scale(50);
  learn(scale, 2.0, 60, 5000);
  EXPECT_NEAR(scale.value(), 2.0, 0.5);
}

}  // namespace povslam
