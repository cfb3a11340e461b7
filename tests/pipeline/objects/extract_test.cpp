#include "pipeline/objects/extract.hpp"

#include <gtest/gtest.h>

#include "tests/support/small_world.hpp"

namespace povslam {
namespace {

std::size_t things_seen(SmallWorld& world, const Rigid3& T_world_camera) {
  DepthView view;
  ImageU8 labels;
  world.look(T_world_camera, 0, view, labels);
  Extractor extractor(ExtractOptions{}, 0.0025);
  return extractor.from_classes(labels, SmallWorld::classes(), view).observations.size();
}

TEST(Extract, ThingsTooNearToLookBetweenAreTwo) {
  SmallWorld world;
  world.things = {{{{2.5, 0.40, 0.5}, {0.5, 0.7, 1.0}, 0.0}}, {{{2.5, -0.38, 0.5}, {0.5, 0.7, 1.0}, 0.0}}};
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(things_seen(world, SmallWorld::looking({0.3, -1.4 + 0.05 * i}, {2.4, 0.2})), 2U) << i;
  }
}

TEST(Extract, OneThingIsOne) {
  SmallWorld world;
  world.things = {{{{2.8, 0.0, 0.3}, {0.6, 1.2, 0.6}, 0.3}}};
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(things_seen(world, SmallWorld::looking({0.6 + 0.1 * i, -1.6}, {2.6, 0.0})), 1U) << i;
  }
}

std::vector<Observation> seen(SmallWorld& world, const Rigid3& T_world_camera) {
  DepthView view;
  ImageU8 labels;
  world.look(T_world_camera, 0, view, labels);
  Extractor extractor(ExtractOptions{}, 0.0025);
  return extractor.from_classes(labels, SmallWorld::classes(), view).observations;
}

TEST(Extract, TellsWhereThingsSideBySideEnd) {
  SmallWorld world;
  world.things = {{{{2.5, 0.38, 0.5}, {0.5, 0.7, 1.0}, 0.0}}, {{{2.5, -0.38, 0.5}, {0.5, 0.7, 1.0}, 0.0}}};
  const auto things = seen(world, SmallWorld::looking({0.3, -0.6}, {2.4, 0.0}));
  ASSERT_EQ(things.size(), 2U);
  for (const Observation& thing : things) {
    ASSERT_EQ(thing.fences.size(), 1U);
    EXPECT_NEAR(thing.fences[0].at.y(), 0.0, 0.06);
    EXPECT_GT(thing.fences[0].outward.y() * (thing.box.center.y() > 0.0 ? -1.0 : 1.0), 0.7) << "towards the other";
  }
}

TEST(Extract, APostDoesNotTellTwoThingsApart) {
  SmallWorld world;
  world.things = {{{{2.5, 0.0, 0.5}, {0.5, 0.9, 1.0}, 0.0}},
                  {{{2.0, 0.0, 1.0}, {0.05, 0.08, 2.0}, 0.0}, SmallWorld::kWall}};
  const auto things = seen(world, SmallWorld::looking({0.0, 0.0}, {2.5, 0.0}));
  ASSERT_EQ(things.size(), 2U) << "left and right of the post";
  for (const Observation& thing : things) EXPECT_TRUE(thing.fences.empty());
}

}  // namespace
}  // namespace povslam
