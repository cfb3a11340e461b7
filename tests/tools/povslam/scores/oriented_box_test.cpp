#include "tools/povslam/scores/oriented_box.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

namespace povslam::scores {
namespace {

bool contains(const OrientedBox& box, const Eigen::Vector3d& p_world) {
  const Eigen::Vector3d p = Eigen::AngleAxisd(-box.yaw_rad, Eigen::Vector3d::UnitZ()) * (p_world - box.center_world);
  return ((2.0 * p).cwiseAbs().array() <= box.size_m.array()).all();
}

OrientedBox random_box() {
  const auto number = [](int low, int high) { return *rc::gen::inRange(low, high) / 1000.0; };
  OrientedBox box;
  box.center_world = {number(-500, 500), number(-500, 500), number(-300, 300)};
  box.size_m = {number(300, 1500), number(300, 1500), number(300, 1500)};
  box.yaw_rad = number(-3200, 3200);
  return box;
}

}  // namespace

RC_GTEST_PROP(OrientedBox, IntersectionAgreesWithCountingRandomPoints, ()) {
  const OrientedBox a = random_box(), b = random_box();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  constexpr int kPoints = 4000;
  int common = 0;
  const Eigen::AngleAxisd turn(a.yaw_rad, Eigen::Vector3d::UnitZ());
  for (int i = 0; i < kPoints; ++i) {
    const Eigen::Vector3d share(unit(random), unit(random), unit(random));
    if (contains(b, a.center_world + turn * share.cwiseProduct(a.size_m))) ++common;
  }
  const double share = static_cast<double>(common) / kPoints;
  const double sigma = std::sqrt(0.25 / kPoints);
  RC_ASSERT(std::abs(intersection_volume(a, b) / a.size_m.prod() - share) < 5.0 * sigma);
}

RC_GTEST_PROP(OrientedBox, IouIsSymmetricAndOneForTheSameBoxTurnedByHalfATurn, ()) {
  const OrientedBox a = random_box(), b = random_box();
  RC_ASSERT(std::abs(box_iou(a, b) - box_iou(b, a)) < 1e-9);
  OrientedBox turned = a;
  turned.yaw_rad += std::numbers::pi;
  RC_ASSERT(std::abs(box_iou(a, turned) - 1.0) < 1e-9);
}

RC_GTEST_PROP(OrientedBox, TheJoinedBoxHoldsBoth, ()) {
  const OrientedBox a = random_box(), b = random_box();
  const OrientedBox both = joined(a, b);
  RC_ASSERT(std::abs(intersection_volume(both, a) - a.size_m.prod()) < 1e-9);
  RC_ASSERT(std::abs(intersection_volume(both, b) - b.size_m.prod()) < 1e-9);
}

TEST(OrientedBox, HalfOverlappingCubesHaveAThird) {
  const OrientedBox a{{0.0, 0.0, 0.5}, {1.0, 1.0, 1.0}, 0.0}, b{{0.5, 0.0, 0.5}, {1.0, 1.0, 1.0}, 0.0};
  EXPECT_NEAR(box_iou(a, b), 1.0 / 3.0, 1e-12);
  const OrientedBox above{{0.0, 0.0, 1.6}, {1.0, 1.0, 1.0}, 0.0};
  EXPECT_EQ(box_iou(a, above), 0.0);
}

TEST(OrientedBox, ASquareTurnedByAnEighthOverlapsInAnOctagon) {
  const OrientedBox a{{3.0, 4.0, 0.0}, {1.0, 1.0, 2.0}, 0.0}, b{{3.0, 4.0, 0.0}, {1.0, 1.0, 2.0}, std::numbers::pi / 4};
  EXPECT_NEAR(intersection_volume(a, b), 2.0 * 2.0 * (std::sqrt(2.0) - 1.0), 1e-12);
}

TEST(OrientedBox, BoxesTouchUpToTheGapAndNoFurther) {
  const OrientedBox a{{0.0, 0.0, 0.5}, {1.0, 1.0, 1.0}, 0.0};
  const OrientedBox near{{1.015, 0.0, 0.5}, {1.0, 1.0, 1.0}, 0.0}, far{{1.025, 0.0, 0.5}, {1.0, 1.0, 1.0}, 0.0};
  EXPECT_TRUE(boxes_touch(a, near, 0.02));
  EXPECT_FALSE(boxes_touch(a, far, 0.02));
}

TEST(OrientedBox, YawIsComparedModuloHalfATurn) {
  EXPECT_NEAR(yaw_difference_mod_half_turn(0.1, 0.1 + std::numbers::pi), 0.0, 1e-12);
  EXPECT_NEAR(yaw_difference_mod_half_turn(-1.5, 1.5), std::numbers::pi - 3.0, 1e-12);
}

}  // namespace povslam::scores
