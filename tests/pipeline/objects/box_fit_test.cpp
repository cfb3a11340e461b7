#include "pipeline/objects/box_fit.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <vector>

namespace povslam {
namespace {

using Points = std::vector<Eigen::Vector3f>;
enum class Sides { one, two, all };

// Points on the upright sides of a box as a noisy camera measures them.
Points sides_of(const Box& box, Sides sides, float noise_m = 0.01F) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  std::normal_distribution<float> noise(0.0F, noise_m);
  const Eigen::AngleAxisd turn(box.yaw, Eigen::Vector3d::UnitZ());
  Points points;
  const int count = sides == Sides::one ? 1 : sides == Sides::two ? 2 : 4;
  for (int side = 0; side < count; ++side) {
    for (int i = 0; i < 400; ++i) {
      Eigen::Vector3d p(unit(random), unit(random), unit(random));
      p[side % 2] = side < 2 ? -0.5 : 0.5;
      const Eigen::Vector3d world = box.center + turn * p.cwiseProduct(box.size_m);
      points.push_back(world.cast<float>() + Eigen::Vector3f(noise(random), noise(random), noise(random)));
    }
  }
  return points;
}

double heading_difference(double a, double b) {  // a box turned by a quarter has its sides exchanged
  return std::abs(std::remainder(a - b, 0.5 * std::numbers::pi));
}

class FittedBox : public testing::TestWithParam<double> {};

TEST_P(FittedBox, LiesAlongTwoSeenSides) {
  const Box truth{{3.0, -2.0, 0.5}, {1.2, 0.7, 1.0}, GetParam()};
  const Box fitted = fit_box(sides_of(truth, Sides::two), 0.01);
  EXPECT_LT(heading_difference(fitted.yaw, truth.yaw), 0.03);
  EXPECT_LT((fitted.center - truth.center).norm(), 0.04);
  EXPECT_GT(overlap(fitted, truth).iou, 0.88);
}

TEST_P(FittedBox, LiesAlongFourSides) {
  const Box truth{{-1.0, 4.0, 0.3}, {0.6, 0.5, 0.6}, GetParam()};
  EXPECT_GT(overlap(fit_box(sides_of(truth, Sides::all), 0.01), truth).iou, 0.85);
}

TEST_P(FittedBox, OfOneSideIsThinAlongIt) {
  const Box truth{{0.0, 2.0, 0.5}, {0.8, 1.1, 1.0}, GetParam()};
  const Box fitted = fit_box(sides_of(truth, Sides::one), 0.01);
  EXPECT_LT(heading_difference(fitted.yaw, truth.yaw), 0.03);
  EXPECT_NEAR(fitted.size_m.head<2>().maxCoeff(), 1.1, 0.05);
  EXPECT_LT(fitted.size_m.head<2>().minCoeff(), 0.08);
}

INSTANTIATE_TEST_SUITE_P(Headings, FittedBox, testing::Values(0.0, 0.3, 0.785, 1.2, 1.55, -0.6, -1.5));

TEST(FittedBox, IgnoresTheFewPointsThatStray) {
  const Box truth{{0.0, 0.0, 0.5}, {1.0, 1.0, 1.0}, 0.2};
  Points points = sides_of(truth, Sides::all);
  for (int i = 0; i < 8; ++i) points.emplace_back(3.0F, 3.0F + 0.1F * static_cast<float>(i), 2.0F);
  EXPECT_GT(overlap(fit_box(points, 0.01), truth).iou, 0.85);
}

TEST(FittedBox, OfNothingHasNoSize) {
  EXPECT_TRUE(fit_box({}, 0.01).size_m.isZero());
  EXPECT_TRUE(fit_box(Points(2, Eigen::Vector3f::Ones()), 0.01).size_m.isZero());
}

TEST(BoxOverlap, IsExactForShiftedAndTurnedBoxes) {
  const Box a{{0, 0, 0}, {2, 1, 1}, 0.0};
  EXPECT_NEAR(overlap(a, a).iou, 1.0, 1e-12);
  EXPECT_NEAR(overlap(a, {{1, 0, 0}, {2, 1, 1}, 0.0}).iou, 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(overlap(a, {{0, 0, 0.5}, {2, 1, 1}, 0.0}).iou, 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(overlap(a, {{0, 0, 0}, {2, 1, 1}, 0.5 * std::numbers::pi}).iou, 1.0 / 3.0, 1e-9);
  EXPECT_NEAR(overlap(a, {{0, 0, 0}, {0.5, 0.5, 0.5}, 0.7}).of_smaller, 1.0, 1e-9);
  EXPECT_EQ(overlap(a, {{3, 0, 0}, {2, 1, 1}, 0.0}).iou, 0.0);
  EXPECT_EQ(overlap(a, {{0, 0, 2}, {2, 1, 1}, 0.0}).iou, 0.0);
}

TEST(FoldHalfTurn, KeepsTheAxis) {
  for (double yaw = -10.0; yaw < 10.0; yaw += 0.1) {
    const double folded = fold_half_turn(yaw);
    EXPECT_GT(folded, -0.5 * std::numbers::pi - 1e-12);
    EXPECT_LE(folded, 0.5 * std::numbers::pi + 1e-12);
    EXPECT_NEAR(std::sin(folded - yaw), 0.0, 1e-9);
  }
}

}  // namespace
}  // namespace povslam
