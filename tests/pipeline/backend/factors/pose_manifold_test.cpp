#include "pipeline/backend/factors/pose_manifold.hpp"

#include <gtest/gtest.h>

#include <random>

namespace povslam {

namespace {

Vector6d random_xi(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> any(-size, size);
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = any(random);
  return xi;
}

}  // namespace

TEST(PoseManifold, MovesAsRetractDoesAndBack) {
  std::mt19937 random(1);
  const PoseManifold manifold;
  for (int i = 0; i < 100; ++i) {
    const Rigid3 T = se3_exp(random_xi(random, 1.7));
    const Vector6d xi = random_xi(random, 1.5);
    const PoseBlock before = to_block(T);
    PoseBlock after{};
    Vector6d back;
    ASSERT_TRUE(manifold.Plus(before.data(), xi.data(), after.data()));
    ASSERT_TRUE(manifold.Minus(after.data(), before.data(), back.data()));
    EXPECT_LT(local(retract(T, xi), from_block(after)).norm(), 1e-12);
    EXPECT_LT((back - xi).norm(), 1e-9);
  }
}

TEST(PoseManifold, JacobiansMatchDifferencesAndInvertEachOther) {
  std::mt19937 random(2);
  const PoseManifold manifold;
  for (int i = 0; i < 20; ++i) {
    const PoseBlock pose = to_block(se3_exp(random_xi(random, 1.7)));
    Eigen::Matrix<double, 7, 6, Eigen::RowMajor> plus;
    Eigen::Matrix<double, 6, 7, Eigen::RowMajor> minus;
    manifold.PlusJacobian(pose.data(), plus.data());
    manifold.MinusJacobian(pose.data(), minus.data());
    for (int k = 0; k < 6; ++k) {
      constexpr double kStep = 1e-6;
      const Vector6d xi = kStep * Vector6d::Unit(k), opposite = -xi;
      PoseBlock ahead{}, behind{};
      manifold.Plus(pose.data(), xi.data(), ahead.data());
      manifold.Plus(pose.data(), opposite.data(), behind.data());
      for (int j = 0; j < 7; ++j) EXPECT_NEAR(plus(j, k), (ahead[j] - behind[j]) / (2.0 * kStep), 1e-8);
    }
    EXPECT_LT((minus * plus - Matrix6d::Identity()).norm(), 1e-12);
  }
}

}  // namespace povslam
