#include "pipeline/frontend/object_trust.hpp"

#include <gtest/gtest.h>

namespace povslam {

TEST(ObjectTrust, IsWholeForWhatNothingIsKnownOf) {
  const ObjectTrust trust(4);
  EXPECT_EQ(trust.of(-1), 1.0F);
  EXPECT_EQ(trust.of(17), 1.0F);
}

TEST(ObjectTrust, KeepsTheLastWordWithinZeroAndOne) {
  ObjectTrust trust(4);
  trust.set(17, 0.25);
  EXPECT_EQ(trust.of(17), 0.25F);
  trust.set(17, -1.0);
  EXPECT_EQ(trust.of(17), 0.0F);
  trust.set(17, 2.0);
  EXPECT_EQ(trust.of(17), 1.0F);
  trust.set(-1, 0.0);
  EXPECT_EQ(trust.of(-1), 1.0F);
}

TEST(ObjectTrust, HasRoomForSoManyAndForTheNextWhenOneIsForgotten) {
  ObjectTrust trust(3);
  for (int id = 1; id <= 4; ++id) trust.set(id, 0.5);
  EXPECT_EQ(trust.of(3), 0.5F);
  EXPECT_EQ(trust.of(4), 1.0F);
  trust.forget(2);
  EXPECT_EQ(trust.of(2), 1.0F);
  trust.set(4, 0.5);
  EXPECT_EQ(trust.of(4), 0.5F);
  trust.forget(99);
}

}  // namespace povslam
