#include "pipeline/base/time.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace povslam {

RC_GTEST_PROP(Time, SurvivesTheRoundTripThroughSeconds, ()) {
  const TimeNs time = *rc::gen::inRange<TimeNs>(-1'000'000 * kNsPerSecond, 1'000'000 * kNsPerSecond);
  RC_ASSERT(std::abs(from_seconds(to_seconds(time)) - time) <= 1);
}

TEST(Time, RoundsSecondsToTheNearestNanosecond) {
  EXPECT_EQ(from_seconds(1e-9), 1);
  EXPECT_EQ(from_seconds(-1e-9), -1);
  EXPECT_EQ(from_seconds(0.1), 100'000'000);
}

TEST(Time, SaturatesInsteadOfOverflowing) {
  EXPECT_EQ(from_seconds(1e300), std::numeric_limits<TimeNs>::max());
  EXPECT_EQ(from_seconds(-1e300), std::numeric_limits<TimeNs>::min());
  EXPECT_EQ(from_seconds(std::numeric_limits<double>::quiet_NaN()), std::numeric_limits<TimeNs>::max());
}

TEST(Time, ClocksOfThisHostGoForward) {
  const TimeNs first = monotonic_now();
  EXPECT_GE(monotonic_now(), first);
  EXPECT_GT(wall_now(), from_seconds(1.6e9));  // after 2020
  const TimeNs this_thread = thread_cpu_now();
  EXPECT_LE(this_thread, process_cpu_now());
}

}  // namespace povslam
