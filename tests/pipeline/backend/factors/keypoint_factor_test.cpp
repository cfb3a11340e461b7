#include "pipeline/backend/factors/keypoint_factor.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <random>

#include "pipeline/backend/factors/depth_factor.hpp"
#include "pipeline/backend/factors/pose_manifold.hpp"

namespace povslam {

namespace {

constexpr KeypointObservation kSeen{525.0, 520.0, 319.5, 239.5, 100.0, 300.0, 0.8};

struct Case {
  PoseBlock pose{};
  Eigen::Vector3d p_world;
};

// A random pose and a point at depth z_m in front of its camera.
Case random_case(std::mt19937& random, double z_m) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const auto vector = [&] {
    const double x = any(random), y = any(random), z = any(random);
    return Eigen::Vector3d(x, y, z);
  };
  const Rigid3 T_world_camera{so3_exp(3.0 * vector()), 4.0 * vector()};
  const Eigen::Vector3d p_camera = z_m * Eigen::Vector3d(0.6 * any(random), 0.4 * any(random), 1.0);
  return {to_block(T_world_camera), T_world_camera * p_camera};
}

struct Evaluation {
  bool ok = false;
  std::array<double, 2> residual{};
  std::array<double, 14> by_pose{};
  std::array<double, 6> by_point{};
};

Evaluation evaluate(const ceres::CostFunction& factor, const Case& at) {
  Evaluation result;
  const double* blocks[] = {at.pose.data(), at.p_world.data()};
  double* jacobians[] = {result.by_pose.data(), result.by_point.data()};
  result.ok = factor.Evaluate(blocks, result.residual.data(), jacobians);
  return result;
}

Eigen::Vector2d residual_at(const ceres::CostFunction& factor, const Case& at) {
  return Eigen::Vector2d(evaluate(factor, at).residual.data());
}

// Moved along one direction of the pose's tangent (0 to 5) or of the point (6 to 8).
Case moved(const Case& at, int direction, double step) {
  Case result = at;
  const Vector6d xi = direction < 6 ? Vector6d(step * Vector6d::Unit(direction)) : Vector6d(Vector6d::Zero());
  PoseManifold().Plus(at.pose.data(), xi.data(), result.pose.data());
  if (direction >= 6) result.p_world[direction - 6] += step;
  return result;
}

// The analytic derivative by pose tangent and point, as Ceres composes it. Ceres' own GradientChecker is not used: it
// returns Eigen matrices from a library that was built with other alignment than a sanitised build has.
Eigen::Matrix<double, 2, 9> composed(const ceres::CostFunction& factor, const Case& at) {
  const Evaluation result = evaluate(factor, at);
  Eigen::Matrix<double, 7, 6, Eigen::RowMajor> plus;
  PoseManifold().PlusJacobian(at.pose.data(), plus.data());
  const int rows = factor.num_residuals();
  Eigen::Matrix<double, 2, 9> J = Eigen::Matrix<double, 2, 9>::Zero();
  using ByPose = Eigen::Matrix<double, Eigen::Dynamic, 7, Eigen::RowMajor>;
  using ByPoint = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  J.topLeftCorner(rows, 6) = Eigen::Map<const ByPose>(result.by_pose.data(), rows, 7) * plus;
  J.topRightCorner(rows, 3) = Eigen::Map<const ByPoint>(result.by_point.data(), rows, 3);
  return J;
}

void expect_gradients_match(const ceres::CostFunction& factor) {
  constexpr double kStep = 1e-6;
  std::mt19937 random(3);
  for (int i = 0; i < 100; ++i) {
    const Case at = random_case(random, 0.2 + 0.1 * i);
    const Eigen::Matrix<double, 2, 9> analytic = composed(factor, at);
    for (int k = 0; k < 9; ++k) {
      const Eigen::Vector2d difference =
          (residual_at(factor, moved(at, k, kStep)) - residual_at(factor, moved(at, k, -kStep))) / (2.0 * kStep);
      EXPECT_LT((analytic.col(k) - difference).norm(), 1e-6 * analytic.norm())
          << "direction " << k << ", point at " << 0.2 + 0.1 * i << " m";
    }
  }
}

void expect_no_pull_from_behind(const ceres::CostFunction& factor) {
  std::mt19937 random(5);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double z_m : {-3.0, -1e-9, 0.0, 1e-300, 0.04, nan}) {
    const Evaluation result = evaluate(factor, random_case(random, z_m));
    EXPECT_TRUE(result.ok);
    for (int i = 0; i < factor.num_residuals(); ++i) EXPECT_EQ(result.residual[i], KeypointFactor::kBehindResidual);
    for (const double j : result.by_pose) EXPECT_EQ(j, 0.0);
    for (const double j : result.by_point) EXPECT_EQ(j, 0.0);
  }
  EXPECT_NE(evaluate(factor, random_case(random, 0.06)).by_point[0], 0.0);
}

}  // namespace

TEST(KeypointFactor, JacobiansMatchDifferences) {
  expect_gradients_match(KeypointFactor(kSeen));
}

TEST(DepthFactor, JacobiansMatchDifferences) {
  expect_gradients_match(DepthFactor(0.4, 0.0025));
}

TEST(KeypointFactor, IsTheWhitenedDifferenceToTheObservation) {
  const Case at{to_block(Rigid3{}), Eigen::Vector3d(-0.5, 0.25, 2.0)};
  const Evaluation result = evaluate(KeypointFactor(kSeen), at);
  EXPECT_NEAR(result.residual[0], (525.0 * -0.25 + 319.5 - 100.0) / 0.8, 1e-9);
  EXPECT_NEAR(result.residual[1], (520.0 * 0.125 + 239.5 - 300.0) / 0.8, 1e-9);
}

TEST(DepthFactor, IsTheWhitenedDifferenceOfInverseDepths) {
  const Case at{to_block(Rigid3{}), Eigen::Vector3d(-0.5, 0.25, 2.0)};
  EXPECT_NEAR(evaluate(DepthFactor(0.4, 0.0025), at).residual[0], (0.5 - 0.4) / 0.0025, 1e-9);
}

TEST(KeypointFactor, StaysFiniteAndPullsNowhereBehindTheCamera) {
  expect_no_pull_from_behind(KeypointFactor(kSeen));
}

TEST(DepthFactor, StaysFiniteAndPullsNowhereBehindTheCamera) {
  expect_no_pull_from_behind(DepthFactor(0.4, 0.0025));
}

}  // namespace povslam
