#include "tools/povslam/scores/trajectory_score.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

#include "tools/povslam/scores/trajectory_report.hpp"

namespace povslam::scores {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;

Rigid3 pose(double x, double y, double z, double yaw_rad = 0.0) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())), {x, y, z}};
}

// A bent path of 10 s at 10 Hz.
std::vector<StampedPose> bent_path() {
  std::vector<StampedPose> path;
  for (int i = 0; i <= 100; ++i) {
    const double s = 0.1 * i;
    path.push_back({i * 100 * kNsPerMs, pose(std::cos(0.4 * s), std::sin(0.5 * s), 0.1 * s, 0.3 * s)});
  }
  return path;
}

std::vector<StampedPose> carried(const Rigid3& T, std::vector<StampedPose> path) {
  for (StampedPose& stamped : path) stamped.T_world_sensor = T * stamped.T_world_sensor;
  return path;
}

std::vector<ScoredPose> paired(const std::vector<StampedPose>& truth, const std::vector<StampedPose>& estimate) {
  return match_trajectories(truth, estimate, {}, 0.1).poses;
}

std::vector<TimeNs> stamps_of(const std::vector<StampedPose>& path) {
  std::vector<TimeNs> stamps;
  for (const StampedPose& stamped : path) stamps.push_back(stamped.stamp);
  return stamps;
}

}  // namespace

RC_GTEST_PROP(TrajectoryScore, AnotherWorldFrameCostsNothingOnceTheFirstPoseIsFixedOrTheRunAligned, ()) {
  const auto number = [](int reach) { return *rc::gen::inRange(-reach, reach) / 1000.0; };
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = number(i < 3 ? 9000 : 1700);
  const std::vector<ScoredPose> poses = paired(bent_path(), carried(se3_exp(xi), bent_path()));
  RC_ASSERT(pose_errors(poses, fix_first_pose(poses)).max_m < 1e-9);
  RC_ASSERT(pose_errors(poses, *align_positions(poses)).max_m < 1e-9);
  RC_ASSERT(pose_errors(poses, align_rotations(poses)).rotation_rmse_deg < 1e-5);
  RC_ASSERT(relative_errors(poses, 1.0).translation_rmse_m < 1e-9);
}

TEST(TrajectoryScore, AnOffsetOfAllPosesButTheFirstIsTheError) {
  const std::vector<StampedPose> truth = bent_path();
  std::vector<StampedPose> estimate = truth;
  for (std::size_t i = 1; i < estimate.size(); ++i) estimate[i].T_world_sensor.translation.x() += 0.3;
  const std::vector<ScoredPose> poses = paired(truth, estimate);
  const PoseErrors errors = pose_errors(poses, fix_first_pose(poses));
  EXPECT_NEAR(errors.rmse_m, 0.3 * std::sqrt(100.0 / 101.0), 1e-12);
  EXPECT_NEAR(errors.mean_m, 0.3 * 100.0 / 101.0, 1e-12);
  EXPECT_NEAR(errors.median_m, 0.3, 1e-12);
  EXPECT_NEAR(errors.max_m, 0.3, 1e-12);
  EXPECT_LT(pose_errors(poses, *align_positions(poses)).rmse_m, 0.05);
}

TEST(TrajectoryScore, ARotationOfAllPosesButTheFirstIsSeenInDegrees) {
  const std::vector<StampedPose> truth = bent_path();
  std::vector<StampedPose> estimate = truth;
  for (std::size_t i = 1; i < estimate.size(); ++i) {
    estimate[i].T_world_sensor = estimate[i].T_world_sensor * pose(0.0, 0.0, 0.0, 2.0 * kDeg);
  }
  const std::vector<ScoredPose> poses = paired(truth, estimate);
  const PoseErrors errors = pose_errors(poses, fix_first_pose(poses));
  EXPECT_NEAR(errors.rotation_rmse_deg, 2.0 * std::sqrt(100.0 / 101.0), 1e-9);
  EXPECT_LT(errors.max_m, 1e-12);
}

TEST(TrajectoryScore, ADriftOfThreeCentimetresASecondIsTheRelativeErrorOverOneSecond) {
  std::vector<StampedPose> truth, longer, turning;
  for (int i = 0; i <= 90; ++i) {  // a straight run at 30 Hz
    const TimeNs stamp = i * kNsPerSecond / 30;
    truth.push_back({stamp, pose(i / 30.0, 0.0, 0.0)});
    longer.push_back({stamp, pose(1.03 * i / 30.0, 0.0, 0.0)});
    turning.push_back({stamp, pose(i / 30.0, 0.0, 0.0, 0.5 * kDeg * i / 30.0)});
  }
  EXPECT_EQ(relative_errors(paired(truth, longer), 1.0).pairs, 61u);
  EXPECT_NEAR(relative_errors(paired(truth, longer), 1.0).translation_rmse_m, 0.03, 1e-9);
  EXPECT_NEAR(relative_errors(paired(truth, turning), 1.0).rotation_rmse_deg, 0.5, 1e-9);
  EXPECT_EQ(relative_errors(paired(truth, longer), 5.0).pairs, 0u);
}

TEST(TrajectoryScore, AStandstillScoresTheExtentOfThePath) {
  const std::vector<StampedPose> truth{{0, pose(0.0, 0.0, 0.0)}, {kNsPerSecond, pose(2.0, 0.0, 0.0)}};
  const StandstillErrors errors = standstill_errors(match_trajectories(truth, truth, {}, 2.0).poses);
  EXPECT_NEAR(errors.first_fixed_rmse_m, std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(errors.aligned_rmse_m, 1.0, 1e-12);
}

TEST(TrajectoryMatch, TruthIsInterpolatedAtTheEstimatesStamp) {
  const std::vector<StampedPose> truth{{0, pose(0.0, 0.0, 0.0)}, {100 * kNsPerMs, pose(1.0, 0.0, 0.0, 0.2)}};
  const std::vector<StampedPose> estimate{{25 * kNsPerMs, pose(0.25, 0.0, 0.0, 0.05)}};
  const MatchedTrajectory matched = match_trajectories(truth, estimate, {}, 0.1);
  ASSERT_EQ(matched.poses.size(), 1u);
  EXPECT_LT(local(matched.poses[0].T_world_truth, estimate[0].T_world_sensor).norm(), 1e-12);
}

TEST(TrajectoryMatch, AHoleInTheTruthIsCountedAndNotScored) {
  std::vector<StampedPose> truth = bent_path();
  const std::vector<StampedPose> estimate = truth;
  truth.erase(truth.begin() + 40, truth.begin() + 45);
  const MatchedTrajectory matched = match_trajectories(truth, estimate, {}, 0.1);
  EXPECT_EQ(matched.frames_without_truth, 5u);
  EXPECT_EQ(matched.poses.size(), 96u);
}

TEST(TrajectoryMatch, ALostFrameIsScoredWithTheLastPublishedPose) {
  const std::vector<StampedPose> truth = bent_path();
  std::vector<StampedPose> estimate = truth;
  estimate.erase(estimate.begin() + 50, estimate.begin() + 60);
  estimate.erase(estimate.begin());
  const MatchedTrajectory matched = match_trajectories(truth, estimate, stamps_of(truth), 0.1);
  EXPECT_EQ(matched.total_frames, 101u);
  EXPECT_EQ(matched.tracked_frames, 90u);
  EXPECT_EQ(matched.held_frames, 10u);
  EXPECT_EQ(matched.frames_before_first, 1u);
  const ScoredPose& lost = matched.poses[55];  // frame 56
  EXPECT_TRUE(lost.held);
  EXPECT_EQ(lost.T_world_estimate.translation, truth[49].T_world_sensor.translation);
  EXPECT_EQ(lost.T_world_truth.translation, truth[56].T_world_sensor.translation);
}

TEST(TrajectoryMatch, StampsRoundedToMillisecondsStillFindTheirFrame) {
  const std::vector<StampedPose> truth = bent_path();
  std::vector<StampedPose> estimate = truth;
  for (StampedPose& stamped : estimate) stamped.stamp += kNsPerMs / 2;
  EXPECT_EQ(match_trajectories(truth, estimate, stamps_of(truth), 0.1).tracked_frames, 101u);
}

TEST(TrajectoryMatch, WithoutAFrameListCoverageIsTheTruthThatHasAnEstimateNearby) {
  const std::vector<StampedPose> truth = bent_path();
  std::vector<StampedPose> estimate = truth;
  estimate.erase(estimate.begin() + 30, estimate.begin() + 50);
  const MatchedTrajectory matched = match_trajectories(truth, estimate, {}, 0.1);
  EXPECT_EQ(matched.total_frames, 101u);
  EXPECT_EQ(matched.tracked_frames, 83u);  // the two beside the hole are within 0.1 s of an estimate
}

TEST(TrajectoryReport, LapsAreScoredInTheAlignmentOfTheWholeRun) {
  const std::vector<StampedPose> truth = bent_path();
  std::vector<StampedPose> estimate = truth;
  for (std::size_t i = 51; i < estimate.size(); ++i) estimate[i].T_world_sensor.translation.z() += 0.2;
  TrajectoryReportOptions options;
  options.lap1_end = truth[50].stamp;
  const auto report = report_trajectory(truth, carried(pose(5.0, 1.0, 0.0, 1.0), estimate), {}, options);
  ASSERT_TRUE(report);
  const auto& first = report->figures.at("first_fixed");
  EXPECT_NEAR(first.at("lap1").at("ate_rmse_m").get<double>(), 0.0, 1e-9);
  EXPECT_NEAR(first.at("lap2").at("ate_rmse_m").get<double>(), 0.2, 1e-9);
  EXPECT_EQ(first.at("lap2").at("poses").get<int>(), 50);
}

TEST(TrajectoryReport, AnEstimateOnAnotherClockIsAnErrorThatSaysSo) {
  std::vector<StampedPose> estimate = bent_path();
  for (StampedPose& stamped : estimate) stamped.stamp += 1000 * kNsPerSecond;
  const auto report = report_trajectory(bent_path(), estimate, {}, {});
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().message.find("clock"), std::string::npos);
}

}  // namespace povslam::scores
