#include "pipeline/objects/neighbours.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/pipeline/objects/analytic_view.hpp"

namespace povslam {
namespace {

// Of a row along y whose fronts face -x, seen from y_from to y_to; its volume is turned by yaw.
MapObject thing(double y_from, double y_to, double yaw = 0.0) {
  MapObject object(1, VolumeOptions{0.05, 0.2, 10});
  object.T_world_volume = upright({3.05, 0.5 * (y_from + y_to), 1.0}, yaw);
  object.seen.box = {Eigen::Vector3d::Zero(), {0.1, y_to - y_from, 0.6}, 0.0};
  if (yaw != 0.0) object.seen.box.size_m = {y_to - y_from, 0.1, 0.6};
  object.seen.sides[yaw != 0.0 ? 2 : 1] = 100;
  return object;
}

TEST(Neighbour, IsBeyondOneEndAtAGap) {
  const auto right = neighbour(thing(0.0, 0.5), thing(-0.44, -0.04), 1);
  ASSERT_TRUE(right);
  EXPECT_FALSE(right->plus);
  EXPECT_NEAR(right->gap_m, 0.04, 1e-9);
}

TEST(Neighbour, MayHaveAVolumeTurnedByAQuarter) {
  const auto left = neighbour(thing(0.0, 0.5), thing(0.53, 0.9, 0.5 * std::numbers::pi), 1);
  ASSERT_TRUE(left);
  EXPECT_TRUE(left->plus);
  EXPECT_NEAR(left->gap_m, 0.03, 1e-9);
}

TEST(Neighbour, IsNotWhatStandsOnTheNextShelf) {
  MapObject above = thing(-0.44, -0.04);
  above.T_world_volume.translation.z() += 0.9;
  EXPECT_FALSE(neighbour(thing(0.0, 0.5), above, 1));
}

// A post before a thing 0.8 m wide, 3 m away; the camera looks along +x.
TEST(HiddenBetween, IsSoWhereAPostHidTheMiddleInEachView) {
  AnalyticScene scene;
  scene.pitch_rad = 0.0;
  scene.boxes = {{1, {3.2, 0.0, 1.0}, {0.4, 0.8, 0.6}, 0.0}, {0, {2.7, 0.0, 1.0}, {0.1, 0.12, 2.0}, 0.0}};
  const AnalyticView view = cast(scene);
  MapObject right = thing(-0.4, -0.08);
  const MapObject left = thing(0.08, 0.4);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(hidden_between(right, left));
    right.hidden.look(right.seen, right.T_world_volume, view.view);
  }
  EXPECT_TRUE(hidden_between(right, left));
}

TEST(HiddenBetween, IsNotSoWhereTheGapIsOpen) {
  AnalyticScene scene;
  scene.pitch_rad = 0.0;
  scene.boxes = {{1, {3.2, -0.24, 1.0}, {0.4, 0.32, 0.6}, 0.0}, {2, {3.2, 0.24, 1.0}, {0.4, 0.32, 0.6}, 0.0}};
  const AnalyticView view = cast(scene);
  MapObject right = thing(-0.4, -0.08);
  for (int i = 0; i < 5; ++i) right.hidden.look(right.seen, right.T_world_volume, view.view);
  EXPECT_FALSE(hidden_between(right, thing(0.08, 0.4)));
}

}  // namespace
}  // namespace povslam
