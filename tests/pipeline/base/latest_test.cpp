#include "pipeline/base/latest.hpp"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace povslam {
namespace {

constexpr std::uint64_t kOperations = 1'000'000;

// Larger than a cache line; any mixture of two values fails its checksum.
struct Letter {
  std::array<std::uint64_t, 20> words{};
  std::uint64_t checksum = 0;

  void write(std::uint64_t number) {
    checksum = 0;
    for (std::size_t i = 0; i < words.size(); ++i) {
      words[i] = number + i;
      checksum = checksum * 31 + words[i];
    }
  }
  bool whole() const {
    std::uint64_t sum = 0;
    for (const std::uint64_t word : words) sum = sum * 31 + word;
    return sum == checksum;
  }
};

}  // namespace

TEST(Latest, HasNothingBeforeTheFirstValue) {
  Latest<int> mailbox;
  EXPECT_EQ(mailbox.take(), nullptr);
}

TEST(Latest, GivesEachValueOnceAndOnlyTheNewest) {
  Latest<int> mailbox;
  for (int value = 1; value <= 3; ++value) {
    mailbox.draft() = value;
    mailbox.publish();
  }
  ASSERT_NE(mailbox.take(), nullptr);
  EXPECT_EQ(mailbox.take(), nullptr);
  mailbox.draft() = 4;
  EXPECT_EQ(mailbox.take(), nullptr);  // a draft is not published yet
  mailbox.publish();
  EXPECT_EQ(*mailbox.take(), 4);
}

TEST(Latest, KeepsWhatTheReaderHoldsWhileTheWriterGoesOn) {
  Latest<int> mailbox;
  mailbox.draft() = 1;
  mailbox.publish();
  const int* const held = mailbox.take();
  for (int value = 2; value < 10; ++value) {
    mailbox.draft() = value;
    mailbox.publish();
  }
  EXPECT_EQ(*held, 1);
  EXPECT_EQ(*mailbox.take(), 9);
}

TEST(Latest, StartsEachSlotFromThePrototype) {
  Latest<std::vector<int>> mailbox(std::vector<int>(5, 1));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(mailbox.draft().size(), 5U);
    mailbox.publish();
  }
}

TEST(Latest, IsNeverTornNeverGoesBackAndEndsWithTheLastOfAMillion) {
  Latest<Letter> mailbox;
  std::jthread writer([&] {
    for (std::uint64_t number = 1; number <= kOperations; ++number) {
      mailbox.draft().write(number);
      mailbox.publish();
    }
  });
  std::uint64_t last = 0, torn = 0, backward = 0, taken = 0;
  while (last < kOperations) {
    const Letter* const letter = mailbox.take();
    if (letter == nullptr) {
      std::this_thread::yield();
      continue;
    }
    ++taken;
    if (!letter->whole()) ++torn;
    if (letter->words[0] <= last) ++backward;
    last = letter->words[0];
  }
  EXPECT_EQ(torn, 0U);
  EXPECT_EQ(backward, 0U);
  EXPECT_GT(taken, 0U);
}

}  // namespace povslam
