#include "pipeline/backend/factors/relative_pose_factor.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "pipeline/backend/factors/pose_manifold.hpp"

namespace povslam {

namespace {

Vector6d random_xi(std::mt19937& random, double size_m, double size_rad) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  Vector6d xi;
  for (int k = 0; k < 6; ++k) xi[k] = (k < 3 ? size_m : size_rad) * any(random);
  return xi;
}

struct Case {
  std::array<PoseBlock, 2> blocks{};  // from, to
  RelativePose measured;
};

// Two poses anywhere and a measurement off by up to error_rad per axis.
Case random_case(std::mt19937& random, double error_rad) {
  const Rigid3 from = se3_exp(random_xi(random, 4.0, 1.7)), to = se3_exp(random_xi(random, 4.0, 1.7));
  return {{to_block(from), to_block(to)},
          {retract(from.inverse() * to, random_xi(random, 0.5, error_rad)), 0.01, 0.005}};
}

Vector6d residual_at(const Case& at) {
  Vector6d residual;
  const double* blocks[] = {at.blocks[0].data(), at.blocks[1].data()};
  EXPECT_TRUE(RelativePoseFactor(at.measured).Evaluate(blocks, residual.data(), nullptr));
  return residual;
}

Case moved(const Case& at, std::size_t block, const Vector6d& xi) {
  Case result = at;
  PoseManifold().Plus(at.blocks[block].data(), xi.data(), result.blocks[block].data());
  return result;
}

}  // namespace

TEST(RelativePoseFactor, IsZeroWhereThePosesAreAsMeasured) {
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    Case at = random_case(random, 0.0);
    at.measured.T_from_to = from_block(at.blocks[0]).inverse() * from_block(at.blocks[1]);
    EXPECT_LT(residual_at(at).norm(), 1e-10);
  }
}

TEST(RelativePoseFactor, CountsSigmasInTheAxesOfFrom) {
  std::mt19937 random(2);
  const Case at = random_case(random, 0.0);
  const Rigid3 from = from_block(at.blocks[0]);
  const Rigid3 from_to = from.inverse() * from_block(at.blocks[1]);
  Vector6d off;
  off << 0.03, 0.0, 0.0, 0.0, 0.01, 0.0;
  const RelativePose measured{from_to, 0.01, 0.005};
  const Vector6d r = measured.whitened(measured.error(from, from * retract(from_to, off)));
  EXPECT_LT((r - (Vector6d() << 3.0, 0.0, 0.0, 0.0, 2.0, 0.0).finished()).norm(), 1e-9);
}

TEST(RelativePoseFactor, JacobiansMatchDifferences) {
  std::mt19937 random(3);
  for (int i = 0; i < 60; ++i) {
    const Case at = random_case(random, i % 2 == 0 ? 0.01 : 1.2);
    Vector6d residual;
    Eigen::Matrix<double, 6, 7, Eigen::RowMajor> by_block[2];
    const double* blocks[] = {at.blocks[0].data(), at.blocks[1].data()};
    double* jacobians[] = {by_block[0].data(), by_block[1].data()};
    ASSERT_TRUE(RelativePoseFactor(at.measured).Evaluate(blocks, residual.data(), jacobians));
    EXPECT_EQ(residual, residual_at(at));
    for (std::size_t b = 0; b < 2; ++b) {
      Eigen::Matrix<double, 7, 6, Eigen::RowMajor> plus;
      PoseManifold().PlusJacobian(blocks[b], plus.data());
      const Matrix6d by_tangent = by_block[b] * plus;
      for (int k = 0; k < 6; ++k) {
        constexpr double kStep = 1e-6;
        const Vector6d ahead = residual_at(moved(at, b, kStep * Vector6d::Unit(k)));
        const Vector6d behind = residual_at(moved(at, b, -kStep * Vector6d::Unit(k)));
        EXPECT_LT((by_tangent.col(k) - (ahead - behind) / (2.0 * kStep)).norm(), 1e-4) << "block " << b << ", " << k;
      }
    }
  }
}

TEST(RelativePoseFactor, GivesEitherJacobianAlone) {
  std::mt19937 random(4);
  const Case at = random_case(random, 0.1);
  const double* blocks[] = {at.blocks[0].data(), at.blocks[1].data()};
  const RelativePoseFactor factor(at.measured);
  std::array<double, 42> both[2], alone[2];
  double* all[] = {both[0].data(), both[1].data()};
  double* first[] = {alone[0].data(), nullptr};
  double* second[] = {nullptr, alone[1].data()};
  Vector6d residual;
  ASSERT_TRUE(factor.Evaluate(blocks, residual.data(), all));
  ASSERT_TRUE(factor.Evaluate(blocks, residual.data(), first));
  ASSERT_TRUE(factor.Evaluate(blocks, residual.data(), second));
  EXPECT_EQ(both[0], alone[0]);
  EXPECT_EQ(both[1], alone[1]);
}

}  // namespace povslam
