// What smooth() leaves alone, refuses and repeats exactly.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <vector>

#include "pipeline/backend/smooth.hpp"
#include "tests/support/simulated_window.hpp"

namespace povslam {

using simulated::pose_error;
using simulated::small_window;

namespace {

bool same_bytes(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

// NaN equals NaN here: the comparison is of bits.
void expect_same(const SmoothProblem& a, const SmoothProblem& b) {
  ASSERT_EQ(a.poses.size(), b.poses.size());
  ASSERT_EQ(a.points.size(), b.points.size());
  ASSERT_EQ(a.observations.size(), b.observations.size());
  for (std::size_t i = 0; i < a.poses.size(); ++i) {
    const Rigid3 &one = a.poses[i].T_world_camera, &other = b.poses[i].T_world_camera;
    for (int k = 0; k < 4; ++k) EXPECT_TRUE(same_bytes(one.rotation.coeffs()[k], other.rotation.coeffs()[k]));
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(same_bytes(one.translation[k], other.translation[k]));
  }
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(same_bytes(a.points[i].p_world[k], b.points[i].p_world[k]));
  }
  for (std::size_t i = 0; i < a.observations.size(); ++i) {
    EXPECT_EQ(a.observations[i].outlier, b.observations[i].outlier);
  }
}

void expect_refused(const SmoothProblem& asked) {
  SmoothProblem answer = asked;
  smooth(answer, SmoothOptions{});
  EXPECT_FALSE(answer.converged);
  expect_same(asked, answer);
}

}  // namespace

TEST(Smooth, SameQuestionSameBytes) {
  simulated::WindowOptions options = small_window();
  options.share_outliers = 0.05;
  SmoothProblem one = simulated::make_window(options).problem, other = one;
  smooth(one, SmoothOptions{});
  smooth(other, SmoothOptions{});
  EXPECT_TRUE(one.converged);
  EXPECT_TRUE(same_bytes(one.cost_after, other.cost_after));
  expect_same(one, other);
}

TEST(Smooth, LeavesAPointAloneThatOneRayCannotPlaceAndItsPoseUnharmed) {
  simulated::Window window = simulated::make_window(small_window());
  SmoothProblem without = window.problem;
  auto& problem = window.problem;
  const Eigen::Vector3d nowhere = problem.poses.back().T_world_camera * Eigen::Vector3d(0.3, 0.2, 2.5);
  problem.points.push_back({nowhere, 1000, 0});
  SmoothProblem::Observation ray;
  ray.pose = static_cast<std::int32_t>(problem.poses.size()) - 1;
  ray.point = static_cast<std::int32_t>(problem.points.size()) - 1;
  ray.u_px = 600.0F;
  problem.observations.push_back(ray);
  smooth(problem, SmoothOptions{});
  smooth(without, SmoothOptions{});
  EXPECT_TRUE(problem.converged);
  EXPECT_EQ(problem.points.back().p_world, nowhere);
  EXPECT_TRUE(problem.observations.back().outlier);
  EXPECT_EQ(problem.poses.back().T_world_camera.translation, without.poses.back().T_world_camera.translation);
}

TEST(Smooth, AnObservationFromBehindTheCameraIsAnOutlierAndDoesNoHarm) {
  simulated::Window window = simulated::make_window(small_window());
  auto& problem = window.problem;
  problem.points[0].p_world = {0.5, -3.0, 1.0};
  smooth(problem, SmoothOptions{});
  EXPECT_TRUE(problem.converged);
  EXPECT_EQ(problem.points[0].p_world, Eigen::Vector3d(0.5, -3.0, 1.0));
  for (const auto& seen : problem.observations) EXPECT_TRUE(seen.point != 0 || seen.outlier);
  EXPECT_LT(pose_error(window, problem)[0], 0.01);
}

TEST(Smooth, KeepsAPointWhoseRaysMeetNowhere) {
  simulated::Window window = simulated::make_window(small_window());
  auto& problem = window.problem;
  const Eigen::Vector3d before_world = problem.poses[0].T_world_camera * Eigen::Vector3d(0.0, 0.0, 3.0);
  problem.points.push_back({before_world, 1000, 0});
  for (const int pose : {0, 1}) {  // two views of one far direction, a pixel more than parallel
    const Eigen::Vector3d far_camera = problem.poses[pose].T_world_camera.inverse() * (1e4 * before_world);
    SmoothProblem::Observation seen;
    seen.pose = pose;
    seen.point = static_cast<std::int32_t>(problem.points.size()) - 1;
    seen.u_px = static_cast<float>(problem.fx * far_camera.x() / far_camera.z() + problem.cx + pose);
    seen.v_px = static_cast<float>(problem.fy * far_camera.y() / far_camera.z() + problem.cy);
    problem.observations.push_back(seen);
  }
  smooth(problem, SmoothOptions{});
  EXPECT_TRUE(problem.converged);
  EXPECT_EQ(problem.points.back().p_world, before_world);
  EXPECT_TRUE(problem.observations.back().outlier);
}

TEST(Smooth, StaysWithAPoseThatTooFewPointsHold) {
  simulated::Window window = simulated::make_window(small_window());
  auto& problem = window.problem;
  int kept = 0;
  std::erase_if(problem.observations, [&kept](const auto& seen) { return seen.pose == 6 && kept++ >= 1; });
  const Eigen::Vector3d before = problem.poses[6].T_world_camera.translation;
  smooth(problem, SmoothOptions{});
  EXPECT_TRUE(problem.converged);
  EXPECT_EQ(problem.poses[6].T_world_camera.translation, before);
  EXPECT_LT((problem.poses[5].T_world_camera.translation - window.poses[5].translation).norm(), 0.01);
}

TEST(Smooth, RefusesAnEmptyProblem) {
  expect_refused(SmoothProblem{});
  SmoothProblem only_poses = simulated::make_window(small_window()).problem;
  only_poses.observations.clear();
  expect_refused(only_poses);
}

TEST(Smooth, RefusesAProblemWithoutAFixedPose) {
  SmoothProblem problem = simulated::make_window(small_window()).problem;
  for (auto& pose : problem.poses) pose.fixed = false;
  expect_refused(problem);
}

TEST(Smooth, RefusesWhenAllPointsAreAtOnePlace) {
  SmoothProblem problem = simulated::make_window(small_window()).problem;
  for (auto& point : problem.points) point.p_world = {0.5, 3.0, 1.0};
  expect_refused(problem);
}

TEST(Smooth, RefusesWhenMostDoesNotFit) {
  simulated::WindowOptions options = small_window();
  options.share_outliers = 0.6;
  expect_refused(simulated::make_window(options).problem);
}

TEST(Smooth, RefusesNumbersThatAreNone) {
  const SmoothProblem good = simulated::make_window(small_window()).problem;
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const auto bad_float = static_cast<float>(bad);
    const auto refuse = [&good](const auto& spoil) {
      SmoothProblem problem = good;
      spoil(problem);
      expect_refused(problem);
    };
    refuse([&](SmoothProblem& problem) { problem.fx = bad; });
    refuse([&](SmoothProblem& problem) { problem.cy = bad; });
    refuse([&](SmoothProblem& problem) { problem.poses[1].T_world_camera.translation.y() = bad; });
    refuse([&](SmoothProblem& problem) { problem.poses[5].T_world_camera.rotation.w() = bad; });
    refuse([&](SmoothProblem& problem) { problem.points[7].p_world.z() = bad; });
    refuse([&](SmoothProblem& problem) { problem.observations[9].u_px = bad_float; });
    refuse([&](SmoothProblem& problem) { problem.observations[9].inverse_depth_per_m = bad_float; });
    refuse([&](SmoothProblem& problem) { problem.observations[9].sigma_px = bad_float; });
  }
}

TEST(Smooth, RefusesIndicesAndSigmasOutOfRange) {
  const SmoothProblem good = simulated::make_window(small_window()).problem;
  SmoothProblem problem = good;
  problem.observations[3].pose = 7;
  expect_refused(problem);
  problem = good;
  problem.observations[3].point = -1;
  expect_refused(problem);
  problem = good;
  problem.observations[3].sigma_px = 0.0F;
  expect_refused(problem);
  problem = good;
  problem.poses[4].T_world_camera.rotation.coeffs().setZero();
  expect_refused(problem);
}

TEST(Smooth, SurvivesNumbersOfAbsurdSize) {
  SmoothProblem problem = simulated::make_window(small_window()).problem;
  problem.points[7].p_world = {1e300, 1e300, 1e300};
  problem.observations[20].u_px = 1e38F;
  problem.observations[30].sigma_px = 1e-38F;
  problem.poses[5].T_world_camera.translation.x() = 1e200;
  smooth(problem, SmoothOptions{});
  for (const auto& pose : problem.poses) EXPECT_TRUE(pose.T_world_camera.translation.allFinite());
  for (const auto& point : problem.points) EXPECT_TRUE(point.p_world.allFinite());
}

}  // namespace povslam
