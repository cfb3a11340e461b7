#include "pipeline/backend/smooth.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "tests/support/simulated_window.hpp"

namespace povslam {

using simulated::median_point_error;
using simulated::pose_error;
using simulated::small_window;

namespace {

constexpr SmoothOptions kLeastSquares{
    .max_iterations = 30, .huber_pixel = 1e6, .huber_depth = 1e6, .outlier_chi2_pixel = 1e6, .outlier_chi2_depth = 1e6};

Eigen::Vector3d predicted(const SmoothProblem& problem, const SmoothProblem::Observation& seen, const Rigid3& T,
                          const Eigen::Vector3d& p_world) {
  const Eigen::Vector3d p = T.inverse() * p_world;
  return {(problem.fx * p.x() / p.z() + problem.cx) / seen.sigma_px,
          (problem.fy * p.y() / p.z() + problem.cy) / seen.sigma_px,
          seen.inverse_depth_per_m > 0.0F ? 1.0 / p.z() / seen.sigma_inverse_depth_per_m : 0.0};
}

// Information of the free poses (6 each, retract's xi) once the points are eliminated, from differences at the truth.
Eigen::MatrixXd pose_information(const simulated::Window& window) {
  const auto& problem = window.problem;
  constexpr double kStep = 1e-6;
  const auto first_free = std::ranges::find(problem.poses, false, &SmoothProblem::Pose::fixed) - problem.poses.begin();
  const Eigen::Index num_pose = 6 * (std::ssize(problem.poses) - first_free),
                     num_point = 3 * std::ssize(problem.points);
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(num_pose + num_point, num_pose + num_point);
  H.diagonal().tail(num_point).setConstant(1e-6);  // for points that nobody sees
  for (const auto& seen : problem.observations) {
    const Rigid3& T = window.poses[seen.pose];
    const Eigen::Vector3d& p = window.points[seen.point];
    Eigen::Matrix<double, 3, 9> J;
    for (int k = 0; k < 9; ++k) {
      const Eigen::Matrix<double, 9, 1> step = kStep * Eigen::Matrix<double, 9, 1>::Unit(k);
      const Vector6d xi = step.head<6>(), back = -xi;
      const Eigen::Vector3d dp = step.tail<3>();
      J.col(k) =
          (predicted(problem, seen, retract(T, xi), p + dp) - predicted(problem, seen, retract(T, back), p - dp)) /
          (2.0 * kStep);
    }
    const Eigen::Index pose = 6 * (seen.pose - first_free), point = num_pose + 3 * seen.point;
    H.block<3, 3>(point, point) += J.rightCols<3>().transpose() * J.rightCols<3>();
    if (pose < 0) continue;
    H.block<6, 6>(pose, pose) += J.leftCols<6>().transpose() * J.leftCols<6>();
    H.block<6, 3>(pose, point) += J.leftCols<6>().transpose() * J.rightCols<3>();
  }
  const Eigen::MatrixXd cross = H.topRightCorner(num_pose, num_point);
  const Eigen::MatrixXd inner = H.bottomRightCorner(num_point, num_point);
  return H.topLeftCorner(num_pose, num_pose) - cross * inner.llt().solve(cross.transpose());
}

// What pose_error should be at the optimum.
Eigen::Vector2d predicted_pose_error(const simulated::Window& window) {
  const Eigen::VectorXd variance = pose_information(window).inverse().diagonal();
  const Eigen::Map<const Eigen::Matrix<double, 6, Eigen::Dynamic>> by_pose(variance.data(), 6, variance.size() / 6);
  const auto num_poses = static_cast<double>(by_pose.cols());
  return Eigen::Vector2d(by_pose.topRows<3>().sum() / num_poses, by_pose.bottomRows<3>().sum() / num_poses).cwiseSqrt();
}

// Squared error of all free poses together, whitened by the covariance they should have.
double nees(const simulated::Window& window, const SmoothProblem& answer) {
  const Eigen::MatrixXd information = pose_information(window);
  Eigen::VectorXd error(information.rows());
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < answer.poses.size(); ++i) {
    if (answer.poses[i].fixed) continue;
    error.segment<6>(row) = local(window.poses[i], answer.poses[i].T_world_camera);
    row += 6;
  }
  return error.dot(information * error);
}

}  // namespace

TEST(Smooth, BringsAPerturbedWindowBackToTheTruth) {
  simulated::WindowOptions options;
  options.num_fixed = options.num_free = 6;
  options.num_points = 400;
  options.max_observations = 2500;
  simulated::Window window = simulated::make_window(options);
  smooth(window.problem, SmoothOptions{});
  EXPECT_TRUE(window.problem.converged);
  EXPECT_GT(window.problem.iterations, 1);
  EXPECT_LT(window.problem.cost_after, 0.1 * window.problem.cost_before);
  const Eigen::Vector2d predicted_error = predicted_pose_error(window);
  EXPECT_LT(predicted_error[0], 0.004);  // the guess was 0.035 m off
  EXPECT_LT(predicted_error[1], 0.002);  // and 0.017 rad
  EXPECT_LT(pose_error(window, window.problem)[0], 2.0 * predicted_error[0]);
  EXPECT_LT(pose_error(window, window.problem)[1], 2.0 * predicted_error[1]);
  EXPECT_LT(median_point_error(window, window.problem), 0.025);
}

TEST(Smooth, ErrorsOfThePosesAreWhatTheirCovariancePredicts) {
  constexpr int kSeeds = 20, kDof = 6 * 4;
  double sum = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    simulated::WindowOptions options = small_window();
    options.seed = seed;
    simulated::Window window = simulated::make_window(options);
    smooth(window.problem, SmoothOptions{});
    ASSERT_TRUE(window.problem.converged);
    sum += nees(window, window.problem);
  }
  const double mean = sum / kSeeds, sigma = std::sqrt(2.0 * kDof / kSeeds);
  EXPECT_NEAR(mean, kDof, 3.0 * sigma);
}

TEST(Smooth, CostAtTheOptimumIsWhatTheSigmasPredict) {
  double sum = 0.0, dof = 0.0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    simulated::WindowOptions options = small_window();
    options.seed = seed;
    SmoothProblem problem = simulated::make_window(options).problem;
    smooth(problem, kLeastSquares);
    ASSERT_TRUE(problem.converged);
    for (const auto& seen : problem.observations) dof += seen.inverse_depth_per_m > 0.0F ? 3.0 : 2.0;
    dof -= 6.0 * options.num_free + 3.0 * options.num_points;
    sum += 2.0 * problem.cost_after;
  }
  EXPECT_NEAR(sum, dof, 3.0 * std::sqrt(2.0 * dof));
}

TEST(Smooth, FindsPlantedOutliersAndSparesGoodObservations) {
  simulated::WindowOptions options;
  options.num_fixed = options.num_free = 6;
  options.num_points = 400;
  options.max_observations = 3000;
  options.share_outliers = 0.1;
  simulated::Window window = simulated::make_window(options);
  smooth(window.problem, SmoothOptions{});
  ASSERT_TRUE(window.problem.converged);
  int planted = 0, found = 0, good = 0, accused = 0;
  for (std::size_t i = 0; i < window.planted.size(); ++i) {
    const bool marked = window.problem.observations[i].outlier;
    (window.planted[i] ? planted : good) += 1;
    (window.planted[i] ? found : accused) += marked ? 1 : 0;
  }
  ASSERT_GT(planted, 200);
  EXPECT_GT(found, 0.97 * planted);
  EXPECT_LT(accused, 0.02 * good);
  EXPECT_LT(pose_error(window, window.problem)[0], 0.003);
}

TEST(Smooth, AWrongDepthCostsNoPixel) {
  simulated::WindowOptions options;
  options.num_fixed = options.num_free = 6;
  options.num_points = 400;
  options.max_observations = 3000;
  simulated::Window window = simulated::make_window(options);
  std::vector<std::size_t> spoilt;
  for (std::size_t i = 0; i < window.problem.observations.size(); i += 4) {
    auto& seen = window.problem.observations[i];
    if (seen.inverse_depth_per_m == 0.0F) continue;
    seen.inverse_depth_per_m *= 0.7F;  // of the wall behind the edge
    spoilt.push_back(i);
  }
  smooth(window.problem, SmoothOptions{});
  ASSERT_TRUE(window.problem.converged);
  const auto accused =
      std::ranges::count_if(spoilt, [&](std::size_t i) { return window.problem.observations[i].outlier; });
  ASSERT_GT(spoilt.size(), 400U);
  EXPECT_LT(accused, 0.05 * static_cast<double>(spoilt.size()));
  EXPECT_LT(pose_error(window, window.problem)[0], 0.004);
}

TEST(Smooth, HoldsFixedPosesExactly) {
  simulated::Window window = simulated::make_window(small_window());
  const SmoothProblem asked = window.problem;
  smooth(window.problem, SmoothOptions{});
  for (std::size_t i = 0; i < asked.poses.size(); ++i) {
    const Rigid3 &before = asked.poses[i].T_world_camera, &after = window.problem.poses[i].T_world_camera;
    const bool same = before.rotation.coeffs() == after.rotation.coeffs() && before.translation == after.translation;
    EXPECT_EQ(same, asked.poses[i].fixed);
  }
}

TEST(Smooth, TriangulatesPointsThatNobodySawInDepth) {
  simulated::WindowOptions options = small_window();
  options.num_fixed = 6;  // half of the path is known: that gives the scale
  options.share_without_depth = 1.0;
  options.point_error_m = 0.2;
  simulated::Window window = simulated::make_window(options);
  smooth(window.problem, SmoothOptions{.max_iterations = 20});
  EXPECT_TRUE(window.problem.converged);
  EXPECT_LT(median_point_error(window, window.problem), 0.04);  // from 0.3 m
  EXPECT_LT(pose_error(window, window.problem)[0], 0.01);
}

TEST(Smooth, APointFollowsTheOnlyKeyframeThatSawIt) {
  simulated::Window window = simulated::make_window(small_window());
  auto& problem = window.problem;
  const Eigen::Vector3d p_camera(0.25, -0.1, 2.0);
  problem.points.push_back({problem.poses.back().T_world_camera * p_camera, 1000, 0});
  SmoothProblem::Observation seen;
  seen.pose = static_cast<std::int32_t>(problem.poses.size()) - 1;
  seen.point = static_cast<std::int32_t>(problem.points.size()) - 1;
  seen.u_px = static_cast<float>(problem.cx + problem.fx * 0.125);
  seen.v_px = static_cast<float>(problem.cy - problem.fy * 0.05);
  seen.inverse_depth_per_m = 0.5F;
  seen.sigma_inverse_depth_per_m = 0.0025F;
  problem.observations.push_back(seen);
  smooth(problem, SmoothOptions{});
  const Eigen::Vector3d after_camera = problem.poses.back().T_world_camera.inverse() * problem.points.back().p_world;
  EXPECT_LT((after_camera - p_camera).norm(), 0.002);
  EXPECT_LT((problem.points.back().p_world - window.poses.back() * p_camera).norm(), 0.02);
}

TEST(Smooth, MovesOnlyPointsWhenEveryPoseIsFixed) {
  simulated::WindowOptions options = small_window();
  options.num_fixed = 7;
  options.num_free = 0;
  simulated::Window window = simulated::make_window(options);
  smooth(window.problem, SmoothOptions{});
  EXPECT_TRUE(window.problem.converged);
  EXPECT_LT(median_point_error(window, window.problem), 0.03);
}

}  // namespace povslam
