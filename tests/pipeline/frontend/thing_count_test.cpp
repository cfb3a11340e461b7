#include "pipeline/frontend/thing_count.hpp"

#include <gtest/gtest.h>

namespace povslam {
namespace {

// So many landmarks of each owner.
bool one(std::initializer_list<std::pair<std::int64_t, int>> seen) {
  ThingCount count(8);
  for (const auto& [owner, landmarks] : seen) {
    for (int i = 0; i < landmarks; ++i) count.add(owner);
  }
  return count.hangs_on_one();
}

}  // namespace

TEST(ThingCount, OneThingAloneIsOne) {
  EXPECT_TRUE(one({{7, 100}}));
  EXPECT_TRUE(one({{7, 100}, {9, 10}}));   // some told wrongly
  EXPECT_TRUE(one({{7, 200}, {9, 30}}));   // a small share
  EXPECT_TRUE(one({{7, 100}, {-1, 60}}));  // what is not known speaks for nothing
}

TEST(ThingCount, TwoThingsOrAThingAndAWallAreNot) {
  EXPECT_FALSE(one({{7, 100}, {9, 30}}));
  EXPECT_FALSE(one({{7, 100}, {0, 30}}));
  EXPECT_FALSE(one({{0, 100}}));
}

TEST(ThingCount, SaysNothingWhereHardlyAnythingIsKnown) {
  EXPECT_FALSE(one({}));
  EXPECT_FALSE(one({{-1, 100}}));
  EXPECT_FALSE(one({{7, 40}, {-1, 60}}));
}

}  // namespace povslam
