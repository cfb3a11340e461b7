#include "pipeline/objects/front_profile.hpp"

#include <gtest/gtest.h>

#include "pipeline/objects/object.hpp"
#include "tests/pipeline/objects/analytic_view.hpp"

namespace povslam {
namespace {

// Two cartons side by side, 2.5 m away, the right one lower; the groove between them is filled 2 cm behind their
// fronts.
AnalyticScene side_by_side(double gap_m) {
  AnalyticScene scene;
  scene.pitch_rad = 0.0;
  scene.camera_height_m = 0.5;
  scene.boxes = {{1, {2.7, 0.25 + 0.5 * gap_m, 0.5}, {0.4, 0.5, 0.6}, 0.0},
                 {1, {2.7, -0.25 - 0.5 * gap_m, 0.4}, {0.4, 0.5, 0.4}, 0.0},
                 {1, {2.72, 0.0, 0.4}, {0.4, 0.1, 0.4}, 0.0}};
  return scene;
}

SeenBox both() {
  SeenBox seen;
  seen.box = {{2.55, 0.0, 0.5}, {0.1, 1.04, 0.6}, 0.0};
  seen.sides[1] = 100;
  return seen;
}

std::optional<Eigen::Vector2d> groove_in(AnalyticScene scene, int views) {
  constexpr double kSigma = 0.0025;
  FrontProfile profile(both(), *front_side(both()));
  AnalyticView one = cast(scene);
  one.view.owner.resize(scene.camera.width, scene.camera.height);
  const ImageF clean = one.view.depth_m;
  std::mt19937 random(7);
  std::normal_distribution<double> gaussian;
  for (int i = 0; i < views; ++i) {
    for (std::size_t k = 0; k < clean.size(); ++k) {
      const double z = static_cast<double>(clean.data()[k]);
      one.view.owner.data()[k] = one.thing.data()[k] == 1 ? kFirstInstance : kStructure;
      one.view.depth_m.data()[k] = static_cast<float>(z + kSigma * z * z * gaussian(random));
    }
    profile.add(one.view, kFirstInstance, Rigid3{}, kSigma);
  }
  return profile.groove();
}

TEST(FrontProfile, FindsAGrooveShallowerThanTheNoise) {
  const auto at = groove_in(side_by_side(0.04), 20);
  ASSERT_TRUE(at);
  EXPECT_NEAR(at->y(), 0.0, 0.021);
}

TEST(FrontProfile, OfOneThingHasNoGroove) {
  AnalyticScene scene = side_by_side(0.0);
  scene.boxes.resize(2);
  EXPECT_FALSE(groove_in(scene, 20));
}

TEST(FrontProfile, OfAStepBetweenTwoFrontsHasNoGroove) {
  AnalyticScene scene = side_by_side(0.0);
  scene.boxes.resize(2);
  scene.boxes[0].center_world.x() += 0.02;
  EXPECT_FALSE(groove_in(scene, 20));
}

}  // namespace
}  // namespace povslam
