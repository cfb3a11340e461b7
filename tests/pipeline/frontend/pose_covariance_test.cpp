#include "pipeline/frontend/pose_covariance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <random>

#include "tests/pipeline/frontend/made_frame.hpp"

namespace povslam {
namespace {

Matrix6d some_covariance(unsigned seed, double size) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Matrix6d A;
  for (int i = 0; i < 36; ++i) A(i / 6, i % 6) = normal(random);
  return size * size * (A * A.transpose() + Matrix6d::Identity());
}

Vector6d draw(const Matrix6d& covariance, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Vector6d white;
  for (int i = 0; i < 6; ++i) white[i] = normal(random);
  return covariance.llt().matrixL() * white;
}

Rigid3 some_pose() {
  return {so3_exp({0.4, -1.0, 0.7}), {3.0, -2.0, 1.0}};
}

// How alike two covariances are: 1 when equal, for the direction in which they differ most.
Eigen::Vector2d extreme_ratios(const Matrix6d& a, const Matrix6d& b) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> solver(a, b);
  return {solver.eigenvalues().minCoeff(), solver.eigenvalues().maxCoeff()};
}

constexpr int kDraws = 20000;

}  // namespace

TEST(PoseCovariance, TellsTheSpreadOfTheCameraInTheWorld) {
  // Draw errors of T_camera_world as the solver states them and look how T_world_camera spreads.
  PoseSolution solution;
  solution.T_camera_world = some_pose().inverse();
  const Matrix6d sigma = some_covariance(1, 0.001);
  solution.information = sigma.inverse();
  solution.num_inliers = 20;  // so few count in full
  std::mt19937 random(2);
  Matrix6d spread = Matrix6d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Rigid3 drawn = se3_exp(draw(sigma, random)) * solution.T_camera_world;
    const Vector6d xi = local(some_pose(), drawn.inverse());
    spread += xi * xi.transpose() / kDraws;
  }
  const Eigen::Vector2d ratios = extreme_ratios(covariance_to_landmarks(solution), spread);
  EXPECT_GT(ratios[0], 0.93);
  EXPECT_LT(ratios[1], 1.07);
}

TEST(PoseCovariance, DoesNotTakeHundredsOfLandmarksForIndependent) {
  PoseSolution few, many;
  few.information = some_covariance(1, 0.001).inverse();
  few.num_inliers = 50;
  many.information = 10.0 * few.information;
  many.num_inliers = 500;
  const Eigen::Vector2d ratios = extreme_ratios(covariance_to_landmarks(many), covariance_to_landmarks(few));
  EXPECT_NEAR(ratios[0], 1.0, 1e-3);
  EXPECT_NEAR(ratios[1], 1.0, 1e-3);
}

TEST(PoseCovariance, CarriesAKeyframesErrorToTheCamera) {
  // The keyframe errs by xi; what is fixed to it errs along.
  const Rigid3 keyframe = some_pose(), camera = keyframe * Rigid3{so3_exp({0.1, 0.5, 0.0}), {1.5, 0.2, 2.0}};
  const Matrix6d covariance = some_covariance(3, 0.002);
  std::mt19937 random(4);
  Matrix6d spread = Matrix6d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Rigid3 wrong = retract(keyframe, draw(covariance, random));
    const Vector6d xi = local(camera, wrong * keyframe.inverse() * camera);
    spread += xi * xi.transpose() / kDraws;
  }
  const Matrix6d carried = carry_covariance(covariance, keyframe.translation, camera.translation);
  const Eigen::Vector2d ratios = extreme_ratios(carried, spread);
  EXPECT_GT(ratios[0], 0.93);
  EXPECT_LT(ratios[1], 1.07);
}

TEST(PoseCovariance, WeighsKeyframesByTheLandmarksTheyHold) {
  FrontendOptions options;
  options.orb.num_features = 40;
  options.map.max_landmarks = 100;
  Frame frame = made::random_frame(made::half_camera(), options, 40, 1);
  Map map(40, options.map, made::level_scales());
  const Matrix6d sure = Matrix6d::Identity() * 1e-6, unsure = Matrix6d::Identity() * 1e-4;
  map.insert_keyframe(frame, {}, sure, -1);
  map.insert_keyframe(frame, {}, unsure, 0);
  EXPECT_EQ(covariance_of_anchors(map, frame, {}).norm(), 0.0);  // sees nothing
  for (int f = 0; f < 40; ++f) {
    frame.landmark[static_cast<std::size_t>(f)] = map.create_landmark(f < 30 ? 0 : 1, f, {0, 0, 3});
  }
  const Matrix6d expected = 0.75 * sure + 0.25 * unsure;
  EXPECT_LT((covariance_of_anchors(map, frame, {}) - expected).norm(), 1e-12);
}

}  // namespace povslam
