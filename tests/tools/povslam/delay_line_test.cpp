#include "tools/povslam/delay_line.hpp"

#include <gtest/gtest.h>

namespace povslam {

TEST(DelayLine, GivesEachThingBackExactlySoManyFramesLater) {
  DelayLine<int> line(3);
  line.push(10, 1);
  line.push(12, 2);
  EXPECT_EQ(line.pop(10), std::nullopt);
  EXPECT_EQ(line.pop(12), std::nullopt);
  EXPECT_EQ(line.pop(13), 1);
  EXPECT_EQ(line.pop(13), std::nullopt);
  EXPECT_EQ(line.pop(14), std::nullopt);
  EXPECT_EQ(line.pop(15), 2);
}

TEST(DelayLine, KeepsTheOrderOfThingsDueTogether) {
  DelayLine<int> line(1);
  line.push(0, 1);
  line.push(0, 2);
  EXPECT_EQ(line.pop(9), 1);
  EXPECT_EQ(line.pop(9), 2);
  EXPECT_EQ(line.pop(9), std::nullopt);
}

}  // namespace povslam
