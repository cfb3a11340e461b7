#include "drivers/synthetic/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "drivers/synthetic/random.hpp"
#include "drivers/synthetic/scene.hpp"

namespace povslam::synthetic {

TEST(SinCos, AgreesWithTheLibrary) {
  for (double angle_rad = -700.0; angle_rad < 700.0; angle_rad += 0.137) {
    const SinCos own = sin_cos(angle_rad);
    EXPECT_NEAR(own.sin, std::sin(angle_rad), 1e-13);
    EXPECT_NEAR(own.cos, std::cos(angle_rad), 1e-13);
  }
}

TEST(Random, HasTheMomentsItPromises) {
  Random random(5);
  double sum = 0.0, square = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double g = random.gaussian();
    sum += g;
    square += g * g;
  }
  EXPECT_NEAR(sum / 20000, 0.0, 0.03);
  EXPECT_NEAR(square / 20000, 1.0, 0.04);
}

class PathOfScene : public testing::TestWithParam<const char*> {};

TEST_P(PathOfScene, ClosesAndTurnsSmoothly) {
  const LapPath path = scene_path(GetParam(), 3);
  EXPECT_GT(path.length_m(), 20.0);
  EXPECT_LT(path.length_m(), std::string(GetParam()) == "hall" ? 75.0 : 35.0);
  const LapPath::Pose2 start = path.at(0.0), end = path.at(path.length_m() - 1e-9);
  EXPECT_NEAR(start.x, end.x, 1e-6);
  EXPECT_NEAR(start.y, end.y, 1e-6);
  EXPECT_NEAR(end.yaw - start.yaw, 2.0 * kPi, 1e-6);
  constexpr double kStep_m = 0.02;
  double curvature_before = 0.0;
  for (double s = 0.0; s < 2.0 * path.length_m(); s += kStep_m) {
    const LapPath::Pose2 a = path.at(s), b = path.at(s + kStep_m);
    const double step_m = std::hypot(b.x - a.x, b.y - a.y), course = std::atan2(b.y - a.y, b.x - a.x);
    EXPECT_NEAR(step_m, kStep_m, 1e-5);
    EXPECT_NEAR(std::remainder(course - 0.5 * (a.yaw + b.yaw), 2.0 * kPi), 0.0, 2e-3)
        << "not along the heading at " << s;
    const double curvature = (b.yaw - a.yaw) / kStep_m;
    EXPECT_LT(curvature, 0.8);
    EXPECT_LT(std::abs(curvature - curvature_before), 0.05) << "the yaw rate jumps at " << s;
    curvature_before = curvature;
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, PathOfScene, testing::Values("boxsim", "aisle", "twins", "rooms", "hall"));

TEST(PathOfHall, IsLongEnoughToDriftOn) {
  EXPECT_GE(scene_path("hall", 1).length_m(), 60.0);
}

TEST(RobotMotion, StartsFromRestAndFinishesALapOnTime) {
  const RobotMotion motion(scene_path("boxsim", 1), 0.6, 1);
  EXPECT_LT((motion.T_world_body(0.05).translation - motion.T_world_body(0.0).translation).head<2>().norm(), 0.001);
  const double end_s = motion.lap_end_s(1.0);
  EXPECT_LT((motion.T_world_body(end_s).translation - motion.T_world_body(0.0).translation).head<2>().norm(), 1e-6);
  EXPECT_NEAR(end_s, motion.path().length_m() / 0.6, 1.0);
}

TEST(RobotMotion, LooksAheadFromCameraHeightAndTremblesLittle) {
  const RobotMotion motion(scene_path("boxsim", 1), 0.6, 1);
  for (double t = 0.0; t < 30.0; t += 0.31) {
    const Rigid3 T_world_camera = motion.T_world_camera(t);
    EXPECT_NEAR(T_world_camera.translation.z(), RobotMotion::kCameraHeight_m, 0.01);
    const Eigen::Vector3d ahead = T_world_camera.rotation * Eigen::Vector3d::UnitZ();
    EXPECT_NEAR(ahead.z(), 0.0, 0.012);
    EXPECT_NEAR(std::abs(ahead.z()) + ahead.head<2>().dot(motion.T_world_body(t).matrix3().col(0).head<2>()), 1.0,
                0.02);
  }
}

}  // namespace povslam::synthetic
