#include "pipeline/mapping/empty_space.hpp"

#include <gtest/gtest.h>

#include "tests/pipeline/mapping/rendered_view.hpp"

namespace povslam {
namespace {

const Thing kWall{Wall{{1.0, 0.0, 0.0}, 3.0}};
const Thing kBox{Box{{1.5, -0.3, -0.3}, {2.0, 0.3, 0.3}}};
const Rigid3 kEye = looking({0.0, 0.0, 0.0}, {1.0, 0.0, 0.0});

DepthView seen_at(TimeNs stamp, const std::vector<Thing>& things, const Rigid3& eye = kEye, double noise = 1.0) {
  DepthView view = render(things, eye, {.noise = noise, .seed = static_cast<unsigned>(stamp)});
  view.stamp = stamp;
  return view;
}

TEST(EmptySpace, RemembersWhenItWasSeenEmpty) {
  EmptySpace space({});
  EXPECT_FALSE(space.at({1.75, 0.0, 0.0}));
  for (const TimeNs stamp : {100, 200, 300}) space.observe(seen_at(stamp, {kWall}));
  const auto seen = space.at({1.75, 0.0, 0.0});
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->first, 100);
  EXPECT_EQ(seen->last, 300);
  EXPECT_EQ(seen->times, 3);
}

TEST(EmptySpace, IsNeverWhereAThingStandsNorBehindIt) {
  EmptySpace space({});
  for (int k = 0; k < 20; ++k) {
    space.observe(seen_at(k, {kWall, kBox}, looking({0.0, -0.5 + 0.05 * k, 0.1}, {1.7, 0.0, 0.0})));
  }
  for (double x = 1.45; x < 2.05; x += 0.05) {
    for (double y = -0.35; y < 0.36; y += 0.05) EXPECT_FALSE(space.at({x, y, 0.0})) << x << " " << y;
  }
  EXPECT_FALSE(space.at({2.3, 0.0, 0.0}));  // hidden
  EXPECT_FALSE(space.at({3.0, 0.9, 0.0}));  // the wall itself
  EXPECT_FALSE(space.at({3.3, 0.9, 0.0}));
  EXPECT_TRUE(space.at({1.0, 0.0, 0.0}));
  EXPECT_TRUE(space.at({2.3, 0.8, 0.1}));  // beside it
}

TEST(EmptySpace, IsNotKnownOutsideThePictureNorWithoutDepth) {
  EmptySpace space({});
  space.observe(seen_at(1, {kWall}));
  EXPECT_FALSE(space.at({1.0, 1.0, 0.0}));
  EXPECT_FALSE(space.at({-1.0, 0.0, 0.0}));
  EmptySpace blind({});
  blind.observe(seen_at(1, {}, kEye, 0.0));
  EXPECT_EQ(blind.num_cells(), 0);
}

TEST(EmptySpace, ForgetsWhatWasLookedAtLongestAgo) {
  EmptySpace one_look({});
  one_look.observe(seen_at(1, {kWall}));
  const int max_cells = one_look.num_cells() * 4 / 3;
  EmptySpace space({.cell_size_m = 0.1, .max_cells = max_cells});
  const Rigid3 back = looking({0.0, 0.0, 0.0}, {-1.0, 0.0, 0.0});
  const Thing behind{Wall{{1.0, 0.0, 0.0}, -3.0}};
  space.observe(seen_at(1, {kWall}));
  ASSERT_TRUE(space.at({2.2, 0.0, 0.0}));
  space.observe(seen_at(2, {behind}, back));
  EXPECT_LE(space.num_cells(), max_cells);
  EXPECT_GT(space.num_cells(), one_look.num_cells());
  EmptySpace second_look({});
  second_look.observe(seen_at(2, {behind}, back));
  for (const EmptySpace::Cell& cell : second_look.cells(0)) {
    EXPECT_TRUE(space.at(0.1 * Eigen::Vector3d(cell.x + 0.5, cell.y + 0.5, cell.z + 0.5)));
  }
}

TEST(EmptySpace, IsTheSameAfterStoring) {
  EmptySpace space({}), again({});
  space.observe(seen_at(5, {kWall, kBox}, looking({-3.0, -2.0, -1.0}, {1.0, 0.0, 0.0})));
  space.observe(seen_at(9, {kWall}));
  for (const EmptySpace::Cell& cell : space.cells(0)) again.restore(cell);
  EXPECT_EQ(again.num_cells(), space.num_cells());
  for (double x = -3.0; x < 3.0; x += 0.13) {
    for (double y = -2.0; y < 1.0; y += 0.17) {
      const auto a = space.at({x, y, -0.2}), b = again.at({x, y, -0.2});
      ASSERT_EQ(a.has_value(), b.has_value());
      if (a) {
        EXPECT_EQ(a->first, b->first);
        EXPECT_EQ(a->last, b->last);
        EXPECT_EQ(a->times, b->times);
      }
    }
  }
  for (const EmptySpace::Cell& cell : space.cells(9)) EXPECT_EQ(cell.seen.last, 9);
  EXPECT_LT(space.cells(9).size(), space.cells(0).size());
}

}  // namespace
}  // namespace povslam
