#include "pipeline/frontend/motion_model.hpp"

#include <gtest/gtest.h>

namespace povslam {
namespace {

constexpr TimeNs kFrame = 33 * kNsPerMs;

Vector6d speed() {
  Vector6d xi;
  xi << 0.6, -0.1, 0.3, 0.1, 0.8, -0.2;
  return xi;
}

Rigid3 after(double seconds) {
  return se3_exp(seconds * speed());
}

}  // namespace

TEST(MotionModel, PredictsNoMotionBeforeItSawAny) {
  MotionModel motion;
  EXPECT_FALSE(motion.known());
  EXPECT_EQ(local(Rigid3{}, motion.predict(kFrame)).norm(), 0.0);
  EXPECT_EQ(motion.speed_after(after(0.033), kFrame).norm(), 0.0);
}

TEST(MotionModel, GoesOnAsBeforeHoweverLongTheNextFrameTakes) {
  MotionModel motion;
  motion.moved(after(0.033), kFrame);
  EXPECT_LT(local(after(0.033), motion.predict(kFrame)).norm(), 1e-12);
  EXPECT_LT(local(after(0.099), motion.predict(3 * kFrame)).norm(), 1e-12);  // two frames were lost
}

TEST(MotionModel, DoesNotPredictFarAheadNorBack) {
  MotionModel motion;
  motion.moved(after(0.033), kFrame);
  EXPECT_LT(local(after(0.5), motion.predict(20 * kNsPerSecond)).norm(), 1e-12);
  EXPECT_LT(local(Rigid3{}, motion.predict(-kFrame)).norm(), 1e-12);
}

TEST(MotionModel, ForgetsAndIgnoresMotionsThatTookNoTime) {
  MotionModel motion;
  motion.moved(after(0.033), kFrame);
  motion.forget();
  EXPECT_FALSE(motion.known());
  EXPECT_LT(local(Rigid3{}, motion.predict(kFrame)).norm(), 1e-12);
  motion.moved(after(0.033), 0);
  EXPECT_FALSE(motion.known());
  EXPECT_TRUE(motion.predict(kFrame).translation.allFinite());
}

TEST(MotionModel, TellsTheSpeedAtTheEndOfASteadilyQuickeningTurn) {
  // Turning by a t^2 / 2: between two frames the mean speed is that of the middle; at the end it is half a step more.
  constexpr double kAcceleration = 3.0, kStep = 0.1;
  const auto turned = [](double t) {
    return Rigid3{so3_exp({0.0, 0.5 * kAcceleration * t * t, 0.0}), Eigen::Vector3d::Zero()};
  };
  MotionModel motion;
  const TimeNs dt = from_seconds(kStep);
  motion.moved(turned(0.2).inverse() * turned(0.3), dt);
  const Vector6d end = motion.speed_after(turned(0.3).inverse() * turned(0.4), dt);
  EXPECT_NEAR(end[4], kAcceleration * 0.4, 1e-9);
  EXPECT_LT(end.head<3>().norm(), 1e-12);
}

}  // namespace povslam
