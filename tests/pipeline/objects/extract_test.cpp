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

}  // namespace
}  // namespace povslam
