#include "pipeline/frames/frame_merge.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <tuple>
#include <vector>

namespace povslam {
namespace {

using Item = FrameMerge::Item;

std::vector<Item> pop_all(FrameMerge& merge) {
  std::vector<Item> items;
  while (const auto item = merge.pop()) items.push_back(*item);
  return items;
}

bool in_order(const Item& a, const Item& b) {
  return std::tie(a.stamp, a.stream) < std::tie(b.stamp, b.stream);
}

struct Arrival {
  TimeNs at = 0;  // when it reaches the merge
  Item item;
};

// Streams of random rate whose frames arrive up to `max_delay` after their stamp, each stream in its own order.
std::vector<Arrival> random_arrivals(int num_streams, TimeNs max_delay) {
  std::vector<Arrival> arrivals;
  for (int stream = 0; stream < num_streams; ++stream) {
    const int count = *rc::gen::inRange(0, 40);
    TimeNs stamp = 0, arrived = 0;
    for (int i = 0; i < count; ++i) {
      stamp += *rc::gen::inRange<TimeNs>(1, 60);
      arrived = std::max(arrived, stamp + *rc::gen::inRange<TimeNs>(0, max_delay + 1));
      arrivals.push_back({arrived, {stamp, stream, static_cast<std::uint64_t>(i)}});
    }
  }
  std::stable_sort(arrivals.begin(), arrivals.end(), [](const Arrival& a, const Arrival& b) { return a.at < b.at; });
  return arrivals;
}

}  // namespace

RC_GTEST_PROP(FrameMerge, HandsOutAllFramesInTimeOrderWhateverTheJitter, ()) {
  const int num_streams = *rc::gen::inRange(1, 5);
  FrameMerge merge(num_streams, 1.0);
  std::vector<Item> out, expected;
  for (const Arrival& arrival : random_arrivals(num_streams, 100)) {
    RC_ASSERT(merge.push(arrival.item.stream, arrival.item.stamp, arrival.item.ticket));
    expected.push_back(arrival.item);
    for (const Item& item : pop_all(merge)) out.push_back(item);
  }
  for (int stream = 0; stream < num_streams; ++stream) merge.finish(stream);
  for (const Item& item : pop_all(merge)) out.push_back(item);
  std::sort(expected.begin(), expected.end(), in_order);
  RC_ASSERT(out.size() == expected.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    RC_ASSERT(std::tie(out[i].stamp, out[i].stream, out[i].ticket) ==
              std::tie(expected[i].stamp, expected[i].stream, expected[i].ticket));
  }
  RC_ASSERT(merge.pending() == 0U);
}

RC_GTEST_PROP(FrameMerge, StaysInOrderAndCountsTheRestWhenStreamsAreLaterThanItWaits, ()) {
  const int num_streams = *rc::gen::inRange(2, 5);
  FrameMerge merge(num_streams, to_seconds(30));
  std::uint64_t accepted = 0, refused = 0;
  std::vector<Item> out;
  for (const Arrival& arrival : random_arrivals(num_streams, 300)) {
    ++(merge.push(arrival.item.stream, arrival.item.stamp, arrival.item.ticket) ? accepted : refused);
    for (const Item& item : pop_all(merge)) out.push_back(item);
  }
  for (int stream = 0; stream < num_streams; ++stream) merge.finish(stream);
  for (const Item& item : pop_all(merge)) out.push_back(item);
  RC_ASSERT(std::is_sorted(out.begin(), out.end(), [](const Item& a, const Item& b) { return a.stamp < b.stamp; }));
  RC_ASSERT(out.size() == accepted);
  RC_ASSERT(merge.rejected() == refused);
}

TEST(FrameMerge, WaitsForTheStreamThatMayStillDeliverEarlier) {
  FrameMerge merge(2, 1.0);
  EXPECT_TRUE(merge.push(0, 100, 7));
  EXPECT_FALSE(merge.pop());
  EXPECT_TRUE(merge.push(1, 50, 8));
  EXPECT_EQ(merge.pop()->ticket, 8U);
  EXPECT_FALSE(merge.pop());  // stream 1 may deliver 60 next
  EXPECT_TRUE(merge.push(1, 100, 9));
  EXPECT_EQ(merge.pop()->ticket, 7U);  // equal stamps: the lower stream first
  EXPECT_EQ(merge.pop()->ticket, 9U);
}

TEST(FrameMerge, CountsLateAndDoubledStamps) {
  FrameMerge merge(2, 1.0);
  EXPECT_TRUE(merge.push(0, 100, 0));
  EXPECT_FALSE(merge.push(0, 100, 1));
  EXPECT_FALSE(merge.push(0, 90, 2));
  merge.finish(1);
  EXPECT_TRUE(merge.pop());
  EXPECT_FALSE(merge.push(1, 80, 3));
  EXPECT_EQ(merge.rejected(), 3U);
}

TEST(FrameMerge, DoesNotDelayTheOthersForASilentStream) {
  FrameMerge merge(2, 0.1);
  EXPECT_TRUE(merge.push(1, 0, 0));
  EXPECT_FALSE(merge.pop());  // stream 0 may just be slow to start
  TimeNs stamp = 0;
  while (stamp <= 100 * kNsPerMs) EXPECT_TRUE(merge.push(1, stamp += 33 * kNsPerMs, 0));
  EXPECT_EQ(pop_all(merge).size(), 5U);
  for (int i = 0; i < 10; ++i) {  // known silent by now: each frame leaves as it comes
    EXPECT_TRUE(merge.push(1, stamp += 33 * kNsPerMs, 0));
    EXPECT_TRUE(merge.pop());
  }
}

TEST(FrameMerge, WaitsAgainForAStreamThatCameBackWithItsUsualDelay) {
  FrameMerge merge(2, 0.1);
  const auto ms = [](TimeNs time) { return time * kNsPerMs; };
  for (TimeNs t = 0; t <= 1000; t += 20) EXPECT_TRUE(merge.push(0, ms(t), 0));
  EXPECT_EQ(pop_all(merge).size(), 51U);
  EXPECT_FALSE(merge.push(1, ms(960), 0));  // too late to be used, but alive
  EXPECT_TRUE(merge.push(0, ms(1020), 0));
  EXPECT_FALSE(merge.pop());
  EXPECT_TRUE(merge.push(1, ms(1010), 0));
  EXPECT_EQ(merge.pop()->stamp, ms(1010));
}

TEST(FrameMerge, EndsWhenAllStreamsAreFinished) {
  FrameMerge merge(2, 10.0);
  EXPECT_TRUE(merge.push(0, 5, 0));
  merge.finish(1);
  EXPECT_TRUE(merge.pop());
  merge.finish(0);
  EXPECT_FALSE(merge.pop());
}

TEST(FrameMerge, TakesAnyStampThereIs) {
  FrameMerge merge(2, 1e12);
  EXPECT_TRUE(merge.push(0, std::numeric_limits<TimeNs>::min(), 0));
  EXPECT_TRUE(merge.push(0, std::numeric_limits<TimeNs>::max(), 1));
  EXPECT_EQ(pop_all(merge).size(), 2U);  // the two stamps are further apart than any wait
}

TEST(FrameMergeDeathTest, RefusesAStreamItDoesNotHave) {
  FrameMerge merge(2, 1.0);
  EXPECT_DEATH(merge.push(2, 0, 0), "contract failed");
  EXPECT_DEATH(merge.finish(-1), "contract failed");
}

}  // namespace povslam
