// Space that is seen through becomes free; what is hidden, or only seemed to be free, stays.
#include <gtest/gtest.h>

#include "pipeline/mapping/compare.hpp"
#include "pipeline/mapping/integrate.hpp"
#include "tests/pipeline/mapping/rendered_view.hpp"

namespace povslam {
namespace {

constexpr std::uint16_t kThing = kFirstInstance, kOther = kFirstInstance + 1;
const Rigid3 kWorld;
const Thing kFloor{Wall{{0.0, 0.0, 1.0}, 0.0}, kStructure};
const Thing kBack{Wall{{1.0, 0.0, 0.0}, 2.65}, kStructure};  // 5 cm behind the box
const Box kBox{{2.0, -0.3, 0.0}, {2.6, 0.3, 0.6}};

std::vector<Rigid3> in_front(int count) {
  std::vector<Rigid3> poses;
  for (int k = 0; k < count; ++k) {
    const double side = -0.8 + 1.6 * (k % 9) / 8.0;
    poses.push_back(looking({0.3 + 0.1 * (k % 4), side, 0.8 + 0.1 * (k % 3)}, {2.2, 0.0, 0.3}));
  }
  return poses;
}

struct Scene {
  std::vector<Thing> things;
  RenderOptions options{.noise = 1.0, .flying_share = 0.5, .doubt_px = 2, .seed = 1};
};

void look(Volume& volume, std::uint16_t owner, Scene scene, int views) {
  for (const Rigid3& pose : in_front(views)) {
    integrate(volume, render(scene.things, pose, scene.options), owner, kWorld, {});
    ++scene.options.seed;
  }
}

// Of the points that lie in the box or at most so far from it.
int points_in(const Volume& volume, const Box& box, double slack_m, double min_weight = 0.1) {
  int count = 0;
  for (const SurfacePoint& point : surface_points(volume, min_weight)) {
    const Eigen::Vector3d p = point.p_volume.cast<double>();
    count += ((p - box.low).array() > -slack_m).all() && ((box.high - p).array() > -slack_m).all();
  }
  return count;
}

TEST(Carving, AStructureThatLeftVanishesWithinTenLooksHoweverOldItIs) {
  Volume volume({});
  look(volume, kStructure, {{kFloor, kBack, {kBox, kStructure}}}, 200);
  const Box upper{{1.9, -0.4, 0.1}, {2.5, 0.4, 0.7}};  // neither floor nor wall
  ASSERT_GT(points_in(volume, upper, 0.0), 100);
  look(volume, kStructure, {{kFloor, kBack}}, 10);
  EXPECT_LT(points_in(volume, upper, 0.0), 5);
  look(volume, kStructure, {{kFloor, kBack}}, 10);
  EXPECT_EQ(points_in(volume, upper, 0.0), 0);
}

// Down to a voxel from the wall and the floor: there its surface cannot be told from theirs.
TEST(Carving, AnObjectThatLeftVanishesThoughTheWallBehindItIsNear) {
  Volume volume({});
  look(volume, kThing, {{kFloor, kBack, {kBox, kThing}}}, 30);
  const Box apart{{1.8, -0.5, 0.05}, {2.6, 0.5, 0.8}};
  ASSERT_GT(points_in(volume, apart, 0.0), 100);
  look(volume, kThing, {{kFloor, kBack}}, 12);
  EXPECT_LT(points_in(volume, apart, 0.0), 5);
}

TEST(Carving, WhatIsHiddenBehindAnotherThingStaysAsItWas) {
  Volume volume({});
  look(volume, kThing, {{kFloor, kBack, {kBox, kThing}}}, 20);
  std::vector<std::array<std::int16_t, kBlockVoxels>> before;
  for (int k = 0; k < volume.num_blocks(); ++k) before.push_back(volume.block(k).distance);
  const Thing screen{Box{{1.2, -3.0, 0.0}, {1.3, 3.0, 2.0}}, kOther};
  look(volume, kThing, {{kFloor, kBack, screen}}, 30);
  for (int k = 0; k < volume.num_blocks(); ++k)
    EXPECT_EQ(volume.block(k).distance, before[static_cast<std::size_t>(k)]);
}

TEST(Carving, NoiseAndFlyingPixelsDoNotEatTheEdgesOfWhatStands) {
  const Scene clean{{kFloor, kBack, {kBox, kThing}}, {.doubt_px = 2}};
  Scene rough = clean;
  rough.options = {.noise = 2.0, .flying_share = 1.0, .doubt_px = 2, .seed = 7};
  Volume once({}), often({});
  look(once, kThing, clean, 9);
  look(often, kThing, rough, 150);
  const int expected = points_in(once, kBox, 0.03), found = points_in(often, kBox, 0.03);
  EXPECT_GT(found, 0.95 * expected);
  // Nothing grew beyond the box, either.
  EXPECT_LT(points_in(often, kBox, 0.5) - found, 0.1 * found);
}

TEST(Carving, AWrongLabelOnWhatStandsTakesNothingAway) {
  Volume volume({});
  look(volume, kThing, {{kFloor, kBack, {kBox, kThing}}}, 20);
  const int before = points_in(volume, kBox, 0.03);
  look(volume, kThing, {{kFloor, kBack, {kBox, kStructure}}}, 20);  // not segmented: seen as structure
  EXPECT_GT(points_in(volume, kBox, 0.03), 0.95 * before);
}

TEST(Carving, WhatIsOutsideThePictureStaysAsItWas) {
  Volume volume({});
  const Thing wall{Wall{{1.0, 0.0, 0.0}, 4.0}, kStructure};
  for (int k = 0; k < 10; ++k) {
    integrate(volume, render({kFloor, wall}, looking({-1.0 + 0.1 * k, 0.0, 1.0}, {0.5, 0.0, 0.0})), kStructure, kWorld,
              {});
  }
  const Box around{{-0.4, -0.4, -0.3}, {0.4, 0.4, 0.3}};
  const int before = points_in(volume, around, 0.0);
  ASSERT_GT(before, 200);
  for (int k = 0; k < 20; ++k) {  // the camera passes right over it and sees none of it
    const Eigen::Vector3d eye(-0.5 + 0.05 * k, 0.0, 0.4);
    integrate(volume, render({kFloor, wall}, looking(eye, eye + Eigen::Vector3d(1.0, 0.0, 0.2))), kStructure, kWorld,
              {});
  }
  EXPECT_EQ(points_in(volume, around, 0.0), before);
}

TEST(Carving, BlocksWithoutAnySurfaceLeftAreGivenBack) {
  Volume volume({});
  const Thing far_wall{Wall{{1.0, 0.0, 0.0}, 4.0}, kStructure}, ball{Ball{{2.2, 0.0, 0.5}, 0.3}, kThing};
  look(volume, kThing, {{far_wall, ball}}, 20);
  ASSERT_GT(volume.num_blocks(), 4);
  look(volume, kThing, {{far_wall}}, 30);
  EXPECT_EQ(volume.num_blocks(), 0);
}

TEST(Carving, AThingThatComesWhereSpaceWasFreeIsThereSoon) {
  Volume volume({});
  look(volume, kStructure, {{kFloor, kBack}}, 50);
  look(volume, kStructure, {{kFloor, kBack, {kBox, kStructure}}}, 8);
  const Box front{{1.9, -0.25, 0.15}, {2.1, 0.25, 0.55}};
  EXPECT_GT(points_in(volume, front, 0.0), 50);
}

}  // namespace
}  // namespace povslam
