// The factors of the variational EM: what they are zero for, and their Jacobians against differences.
#include <gtest/gtest.h>

#include <random>

#include "pipeline/backend/factors/landmark_prior_factor.hpp"
#include "pipeline/backend/factors/object_point_factor.hpp"
#include "pipeline/backend/factors/pose_manifold.hpp"
#include "pipeline/backend/factors/pose_prior_factor.hpp"
#include "pipeline/backend/factors/rigidity_factor.hpp"
#include "pipeline/backend/factors/vo_transition_factor.hpp"

namespace povslam {

namespace {

using Blocks = std::vector<std::vector<double>>;  // 7 numbers: a pose

class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double any(double size) { return std::uniform_real_distribution<double>(-size, size)(random_); }
  Eigen::Vector3d point(double size) {
    const double x = any(size), y = any(size), z = any(size);
    return {x, y, z};
  }
  Rigid3 pose() { return {so3_exp(point(1.5)), point(4.0)}; }

 private:
  std::mt19937 random_;
};

std::vector<double> block_of(const Rigid3& T) {
  const PoseBlock block = to_block(T);
  return {block.begin(), block.end()};
}
std::vector<double> block_of(const Eigen::Vector3d& p) {
  return {p.x(), p.y(), p.z()};
}

Eigen::VectorXd residual_at(const ceres::CostFunction& factor, const Blocks& blocks) {
  Eigen::VectorXd residual(factor.num_residuals());
  std::vector<const double*> pointers;
  for (const auto& block : blocks) pointers.push_back(block.data());
  EXPECT_TRUE(factor.Evaluate(pointers.data(), residual.data(), nullptr));
  return residual;
}

std::vector<double> moved(const std::vector<double>& block, int k, double step) {
  std::vector<double> result = block;
  if (block.size() == 7) {
    const Vector6d xi = step * Vector6d::Unit(k);
    PoseManifold().Plus(block.data(), xi.data(), result.data());
  } else {
    result[static_cast<std::size_t>(k)] += step;
  }
  return result;
}

// Each block's Jacobian, along the manifold for poses, against central differences; each also asked for alone.
void expect_jacobians(const ceres::CostFunction& factor, const Blocks& blocks) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<const double*> pointers;
  for (const auto& block : blocks) pointers.push_back(block.data());
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    Rows by_block(factor.num_residuals(), static_cast<Eigen::Index>(blocks[b].size()));
    std::vector<double*> jacobians(blocks.size(), nullptr);
    jacobians[b] = by_block.data();
    Eigen::VectorXd residual(factor.num_residuals());
    ASSERT_TRUE(factor.Evaluate(pointers.data(), residual.data(), jacobians.data()));
    EXPECT_EQ(residual, residual_at(factor, blocks));
    Rows by_tangent = by_block;
    if (blocks[b].size() == 7) {
      Eigen::Matrix<double, 7, 6, Eigen::RowMajor> plus;
      PoseManifold().PlusJacobian(blocks[b].data(), plus.data());
      by_tangent = by_block * plus;
    }
    for (int k = 0; k < by_tangent.cols(); ++k) {
      constexpr double kStep = 1e-6;
      Blocks ahead = blocks, behind = blocks;
      ahead[b] = moved(blocks[b], k, kStep);
      behind[b] = moved(blocks[b], k, -kStep);
      const Eigen::VectorXd slope = (residual_at(factor, ahead) - residual_at(factor, behind)) / (2.0 * kStep);
      EXPECT_LT((by_tangent.col(k) - slope).norm(), 1e-6 * (1.0 + slope.norm())) << "block " << b << ", " << k;
    }
  }
}

}  // namespace

TEST(VoTransitionFactor, IsZeroForTheMotionMeasuredAndHasItsJacobians) {
  Dice dice(1);
  for (int i = 0; i < 40; ++i) {
    const Rigid3 before = dice.pose(), after = dice.pose();
    VemTransition Z{before.inverse() * after, 0.05, 0.02};
    EXPECT_LT(residual_at(VoTransitionFactor(Z), {block_of(before), block_of(after)}).norm(), 1e-9);
    Vector6d off;
    off << dice.point(0.3), dice.point(i % 2 == 0 ? 0.01 : 1.0);
    Z.T_before_after = retract(Z.T_before_after, off);
    expect_jacobians(VoTransitionFactor(Z), {block_of(before), block_of(after)});
  }
}

TEST(VoTransitionFactor, CountsMetresAndRadiansApart) {
  const VemTransition Z{{so3_exp({0.0, 0.0, 0.02}), {0.1, 0.0, 0.0}}, 0.05, 0.01};
  const Eigen::VectorXd r = residual_at(VoTransitionFactor(Z), {block_of(Rigid3{}), block_of(Rigid3{})});
  EXPECT_NEAR(r.head<3>().norm(), 2.0, 1e-9);
  EXPECT_NEAR(r.tail<3>().norm(), 2.0, 1e-9);
}

TEST(PosePriorFactor, IsZeroAtThePriorAndHasItsJacobian) {
  Dice dice(2);
  for (int i = 0; i < 40; ++i) {
    const VemPosePrior prior{dice.pose(), 0.01, 0.003};
    EXPECT_LT(residual_at(PosePriorFactor(prior), {block_of(prior.T_world_camera)}).norm(), 1e-9);
    Vector6d off;
    off << dice.point(0.3), dice.point(0.8);
    expect_jacobians(PosePriorFactor(prior), {block_of(retract(prior.T_world_camera, off))});
  }
}

TEST(RigidityFactor, HasTheNormOfThePapersResidualAndItsJacobians) {
  Dice dice(3);
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3d position = dice.point(4.0), p_object = dice.point(1.0), p_world = dice.point(4.0);
    const double yaw = dice.any(3.0);
    const RigidityFactor factor(p_object, 0.02);
    const Blocks blocks = {{position.x(), position.y(), position.z(), yaw}, block_of(p_world)};
    const Rigid3 T_world_object{so3_exp({0.0, 0.0, yaw}), position};
    const double paper = (T_world_object.inverse() * p_world - p_object).norm() / 0.02;
    EXPECT_NEAR(residual_at(factor, blocks).norm(), paper, 1e-9 * paper);
    expect_jacobians(factor, blocks);
  }
}

TEST(LandmarkPriorFactor, CountsSigmasFromWhereTheMapHasIt) {
  const LandmarkPriorFactor factor({1.0, 2.0, 3.0}, 0.05);
  EXPECT_NEAR(residual_at(factor, {{1.0, 2.1, 3.0}}).norm(), 2.0, 1e-9);
  expect_jacobians(factor, {{1.3, 2.1, 2.0}});
}

TEST(ObjectPointFactor, WeighsByTheInformationOfTheMomentAndHasItsJacobians) {
  Dice dice(4);
  for (int i = 0; i < 40; ++i) {
    double information = 1.0 / (0.05 * 0.05);
    const Eigen::Vector3d p_camera = dice.point(4.0), p_world = dice.point(4.0);
    const Rigid3 pose = dice.pose();
    const ObjectPointFactor factor(p_camera, &information);
    const Blocks blocks = {block_of(pose), block_of(p_world)};
    EXPECT_NEAR(residual_at(factor, blocks).norm(), (pose * p_camera - p_world).norm() / 0.05, 1e-9);
    expect_jacobians(factor, blocks);
    information = 0.0;  // rejected
    EXPECT_EQ(residual_at(factor, blocks).norm(), 0.0);
  }
}

}  // namespace povslam
