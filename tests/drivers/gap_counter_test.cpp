#include "drivers/gap_counter.hpp"

#include <gtest/gtest.h>

namespace povslam {
namespace {

TEST(GapCounter, CountsWhatIsMissingBetweenTwoFrames) {
  GapCounter gaps;
  EXPECT_EQ(gaps.missing_before(7), 0) << "before the first nothing is known";
  EXPECT_EQ(gaps.missing_before(8), 0);
  EXPECT_EQ(gaps.missing_before(12), 3);
}

TEST(GapCounter, LeavesOutWhatWasCountedAsBad) {
  GapCounter gaps;
  gaps.missing_before(0);
  gaps.bad();
  EXPECT_EQ(gaps.missing_before(3), 1);
  gaps.bad();
  EXPECT_EQ(gaps.missing_before(4), 0) << "a bad one more than are missing is no gap";
  EXPECT_EQ(gaps.missing_before(6), 1);
}

TEST(GapCounter, BeginsAgainWithTheDevice) {
  GapCounter gaps;
  gaps.missing_before(100);
  gaps.reset();
  EXPECT_EQ(gaps.missing_before(500), 0);
}

}  // namespace
}  // namespace povslam
