#include "pipeline/base/spsc_ring.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <memory>
#include <numeric>
#include <thread>
#include <vector>

namespace povslam {
namespace {

constexpr std::uint64_t kOperations = 1'000'000;

// A value that owns memory and can only be moved: a torn, lost or doubled one shows.
struct Parcel {
  std::uint64_t number = 0;
  std::unique_ptr<std::uint64_t> copy;
};
Parcel parcel(std::uint64_t number) {
  return {number, std::make_unique<std::uint64_t>(number)};
}

struct Copyable {
  std::vector<int> buffer;
};

// Pushes 0 … count - 1, waiting for room, and closes.
template <class Ring>
void produce(Ring& ring, std::uint64_t count) {
  for (std::uint64_t number = 0; number < count; ++number) {
    Parcel value = parcel(number);
    while (!ring.try_push(std::move(value))) std::this_thread::yield();
  }
  ring.close();
}

}  // namespace

TEST(SpscRing, TakesExactlyItsCapacityAndKeepsOrder) {
  SpscRing<Parcel> ring(3);
  for (std::uint64_t i = 0; i < 3; ++i) EXPECT_TRUE(ring.try_push(parcel(i)));
  EXPECT_EQ(ring.size(), 3U);
  EXPECT_EQ(ring.capacity(), 3U);
  EXPECT_FALSE(ring.try_push(parcel(3)));
  for (std::uint64_t i = 0; i < 3; ++i) EXPECT_EQ(ring.try_pop()->number, i);
  EXPECT_FALSE(ring.try_pop());
}

TEST(SpscRing, LeavesARefusedValueWithTheProducer) {
  SpscRing<Parcel> ring(1);
  EXPECT_TRUE(ring.try_push(parcel(1)));
  Parcel second = parcel(2);
  EXPECT_FALSE(ring.try_push(std::move(second)));
  ASSERT_NE(second.copy, nullptr);
  EXPECT_EQ(*second.copy, 2U);
}

TEST(SpscRing, MovesBuffersInsteadOfCopyingThem) {
  SpscRing<Copyable> ring(2);
  Copyable value{std::vector<int>(1000, 7)};
  const int* const memory = value.buffer.data();
  EXPECT_TRUE(ring.try_push(std::move(value)));
  EXPECT_EQ(ring.pop()->buffer.data(), memory);
}

TEST(SpscRing, DeliversWhatWasInsideWhenClosedThenEnds) {
  SpscRing<Parcel> ring(4);
  EXPECT_TRUE(ring.try_push(parcel(1)));
  ring.close();
  EXPECT_FALSE(ring.try_push(parcel(2)));
  EXPECT_EQ(ring.pop()->number, 1U);
  EXPECT_FALSE(ring.pop());
  EXPECT_FALSE(ring.pop());
}

TEST(SpscRing, CloseWakesASleepingConsumer) {
  for (int round = 0; round < 200; ++round) {
    SpscRing<Parcel> ring(1);
    auto consumer = std::async(std::launch::async, [&] { return ring.pop().has_value(); });
    if (round % 2 == 0) std::this_thread::sleep_for(std::chrono::microseconds(200));  // asleep, or about to be
    ring.close();
    ASSERT_EQ(consumer.wait_for(std::chrono::seconds(20)), std::future_status::ready);
    EXPECT_FALSE(consumer.get());
  }
}

TEST(SpscRing, DeliversAMillionValuesInOrderToASleepyConsumer) {
  for (const std::size_t capacity : {1, 2, 64}) {
    // A small ring hands the processor over at nearly every value, which on a busy machine takes a turn of everybody's.
    const std::uint64_t values = capacity < 64 ? kOperations / 20 : kOperations * 9 / 10;
    SpscRing<Parcel> ring(capacity);
    std::jthread producer([&] { produce(ring, values); });
    std::uint64_t expected = 0, wrong = 0;
    while (auto value = ring.pop()) {
      if (value->number != expected || !value->copy || *value->copy != expected) ++wrong;
      ++expected;
    }
    EXPECT_EQ(wrong, 0U);
    EXPECT_EQ(expected, values) << "capacity " << capacity;
  }
}

TEST(SpscRing, WakesTheConsumerForEachSingleValue) {  // the consumer sleeps before nearly every push
  SpscRing<Parcel> there(1), back(1);
  std::jthread echo([&] {
    while (auto value = there.pop()) EXPECT_TRUE(back.try_push(std::move(*value)));
  });
  for (std::uint64_t i = 0; i < 20'000; ++i) {
    ASSERT_TRUE(there.try_push(parcel(i)));
    ASSERT_EQ(back.pop()->number, i);
  }
  there.close();
}

TEST(SpscRing, LosesNothingUncountedWhenClosedFromAThirdThread) {
  for (int round = 0; round < 300; ++round) {
    SpscRing<Parcel> ring(4);
    std::uint64_t accepted = 0, received = 0;
    std::jthread producer([&] {
      for (std::uint64_t i = 0; i < 2000; ++i) accepted += ring.try_push(parcel(i)) ? 1 : 0;
    });
    std::jthread closer([&] { ring.close(); });
    while (ring.pop()) ++received;
    producer.join();
    while (ring.try_pop()) ++received;
    ASSERT_EQ(received, accepted);
  }
}

TEST(Doorbell, WakesOneThreadThatWaitsForTwoRings) {
  Doorbell bell;
  SpscRing<int> left(4, &bell), right(4, &bell);
  long sum = 0;
  std::thread consumer([&] {
    for (;;) {
      const std::uint32_t rung = bell.count();
      const bool last = left.closed() && right.closed();
      while (const auto value = left.try_pop()) sum += *value;
      while (const auto value = right.try_pop()) sum += *value;
      if (last) return;
      bell.wait(rung);
    }
  });
  const auto produce_numbers = [](SpscRing<int>& ring) {
    for (int i = 1; i <= 10000;) {
      if (ring.try_push(int{i})) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
    ring.close();
  };
  std::thread other([&] { produce_numbers(left); });
  produce_numbers(right);
  other.join();
  consumer.join();
  EXPECT_EQ(sum, 2 * 10000L * 10001L / 2);
}

TEST(Doorbell, DoesNotSleepThroughAPushBetweenLookingAndWaiting) {
  Doorbell bell;
  SpscRing<int> ring(4, &bell);
  const std::uint32_t rung = bell.count();
  EXPECT_FALSE(ring.try_pop());
  EXPECT_TRUE(ring.try_push(1));
  bell.wait(rung);  // would hang
  EXPECT_EQ(ring.try_pop(), 1);
}

}  // namespace povslam
