#include "pipeline/objects/grooves.hpp"

#include <gtest/gtest.h>

#include "tests/support/small_world.hpp"

namespace povslam {
namespace {

int groove_pixels(SmallWorld& world, const Rigid3& T_world_camera) {
  DepthView view;
  ImageU8 labels;
  world.look(T_world_camera, 0, view, labels);
  ImageU16 value(labels.width(), labels.height());
  for (std::size_t i = 0; i < labels.size(); ++i) {
    value.data()[i] = labels.data()[i] == SmallWorld::kCarton ? std::uint16_t{1} : std::uint16_t{0};
  }
  ImageU8 groove;
  GrooveFinder(0.0025).find(value, view, groove);
  int count = 0;
  for (const std::uint8_t pixel : groove.pixels()) count += pixel;
  return count;
}

TEST(Grooves, LieBetweenThingsTooNearToLookThrough) {
  SmallWorld world;
  world.things = {{{{2.5, 0.40, 0.5}, {0.5, 0.7, 1.0}, 0.0}}, {{{2.5, -0.38, 0.5}, {0.5, 0.7, 1.0}, 0.0}}};
  EXPECT_GT(groove_pixels(world, SmallWorld::looking({0.3, -1.4}, {2.4, 0.2})), 60);
}

TEST(Grooves, AreNotInOneThingHoweverSlanted) {
  SmallWorld world;
  world.things = {{{{2.5, 0.0, 0.5}, {0.5, 1.5, 1.0}, 0.3}}};
  EXPECT_LT(groove_pixels(world, SmallWorld::looking({0.3, -1.4}, {2.4, 0.2})), 20);
}

TEST(Grooves, OfNothingAreNone) {
  SmallWorld world;
  EXPECT_EQ(groove_pixels(world, SmallWorld::looking({0.0, 0.0}, {2.0, 0.0})), 0);
}

}  // namespace
}  // namespace povslam
