#include "pipeline/objects/hidden_ends.hpp"

#include <gtest/gtest.h>

#include "pipeline/objects/object.hpp"
#include "tests/pipeline/objects/analytic_view.hpp"

namespace povslam {
namespace {

// A thing 0.8 m wide, 3 m away, of which a post hides the left half: the camera looks along +x, left is +y.
AnalyticScene thing_behind_post() {
  AnalyticScene scene;
  scene.pitch_rad = 0.0;
  scene.boxes = {{1, {3.2, 0.0, 1.0}, {0.4, 0.8, 0.6}, 0.0}, {0, {2.7, 0.18, 1.0}, {0.1, 0.32, 2.0}, 0.0}};
  return scene;
}

// What was seen of its front, from y_from to y_to.
SeenBox front(double y_from, double y_to) {
  SeenBox seen;
  seen.box = {{3.05, 0.5 * (y_from + y_to), 1.0}, {0.1, y_to - y_from, 0.6}, 0.0};
  seen.sides[1] = 100;
  return seen;
}

HiddenReach reach_after(const AnalyticScene& scene, const SeenBox& seen, int views) {
  const AnalyticView one = cast(scene);
  HiddenEnds ends;
  for (int i = 0; i < views; ++i) ends.look(seen, Rigid3{}, one.view);
  return ends.reach(seen);
}

TEST(HiddenEnds, ReachAsFarAsSomethingNearerHidWhatIsBeyond) {
  const HiddenReach reach = reach_after(thing_behind_post(), front(-0.4, 0.02), 3);
  EXPECT_NEAR(reach.plus_m, 0.35, 0.06);
  EXPECT_EQ(reach.minus_m, 0.0);
}

TEST(HiddenEnds, AreNotBelievedAfterTwoViews) {
  EXPECT_EQ(reach_after(thing_behind_post(), front(-0.4, 0.02), 2).plus_m, 0.0);
}

TEST(HiddenEnds, AreNotWhereOneLooksPastTheThing) {
  AnalyticScene scene = thing_behind_post();
  scene.boxes.pop_back();
  scene.boxes.push_back({0, {6.0, 0.0, 1.0}, {0.2, 8.0, 2.0}, 0.0});  // a wall behind
  const HiddenReach reach = reach_after(scene, front(-0.4, 0.4), 5);
  EXPECT_EQ(reach.plus_m, 0.0);
  EXPECT_EQ(reach.minus_m, 0.0);
}

TEST(HiddenEnds, LieBelowAThingThatStandsBehindAnother) {
  AnalyticScene scene;
  scene.pitch_rad = 0.0;
  scene.boxes = {{1, {3.2, 0.0, 1.0}, {0.4, 0.8, 0.6}, 0.0}, {0, {2.5, 0.0, 0.45}, {0.2, 2.0, 0.9}, 0.0}};
  SeenBox seen = front(-0.4, 0.4);
  seen.box.center.z() = 1.1;
  seen.box.size_m.z() = 0.4;
  EXPECT_GT(reach_after(scene, seen, 3).below_m, 0.15);
}

TEST(Grown, IsNoWiderThanThingsOfItsKind) {
  const SeenBox seen = front(-0.4, 0.0);
  const SeenBox whole = grown(seen, {0.0, 0.5, 0.0}, 0.6, 0.5);
  EXPECT_NEAR(whole.box.size_m.y(), 0.6, 1e-9);
  EXPECT_NEAR(whole.box.center.y(), -0.1, 1e-9);
  EXPECT_NEAR(whole.box.size_m.z(), 0.6, 1e-9);
}

TEST(Grown, DrawsBackAnEndThatReachesIntoANeighbour) {
  const SeenBox whole = grown(front(-0.4, 0.0), {0.0, -0.05, 0.0}, 0.6, 0.5);
  EXPECT_NEAR(whole.box.size_m.y(), 0.35, 1e-9);
  EXPECT_NEAR(whole.box.center.y(), -0.225, 1e-9);
}

}  // namespace
}  // namespace povslam
