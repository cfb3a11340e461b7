#include "pipeline/frontend/place_index.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <vector>

#include "tests/support/alloc_counter.hpp"

namespace povslam {
namespace {

constexpr int kSlots = 40, kFeatures = 100;

std::vector<std::uint32_t> random_words(std::mt19937& random, int count) {
  std::uniform_int_distribution<std::uint32_t> any(0, Vocabulary::shipped().num_words() - 1);
  std::vector<std::uint32_t> words;
  for (int i = 0; i < count; ++i) words.push_back(any(random));
  return words;
}

// Most words of the one, the rest of the other.
std::vector<std::uint32_t> mixed(const std::vector<std::uint32_t>& most, const std::vector<std::uint32_t>& rest,
                                 std::size_t share) {
  std::vector<std::uint32_t> words(most.begin(), most.begin() + static_cast<std::ptrdiff_t>(share));
  words.insert(words.end(), rest.begin(), rest.end() - static_cast<std::ptrdiff_t>(share));
  return words;
}

struct Filled {
  Filled() {
    for (std::int32_t slot = 0; slot < kSlots; ++slot) {
      places.push_back(random_words(random, kFeatures));
      index.add(slot, places.back());
    }
  }
  std::vector<PlaceIndex::Candidate> ask(const std::vector<std::uint32_t>& words) {
    std::vector<PlaceIndex::Candidate> answers;
    index.query(words);
    while (const auto c = index.next()) answers.push_back(*c);
    return answers;
  }
  std::mt19937 random{1};
  PlaceIndex index{Vocabulary::shipped(), kSlots, kFeatures};
  std::vector<std::vector<std::uint32_t>> places;
};

}  // namespace

TEST(PlaceIndex, FindsThePlaceThatSharesMostWords) {
  Filled filled;
  for (std::size_t p = 0; p < filled.places.size(); ++p) {
    const auto answers = filled.ask(mixed(filled.places[p], random_words(filled.random, kFeatures), 40));
    ASSERT_FALSE(answers.empty());
    EXPECT_EQ(answers[0].keyframe, static_cast<std::int32_t>(p));
    EXPECT_GT(answers[0].score, 0.2F);
    for (std::size_t i = 1; i < answers.size(); ++i) EXPECT_LE(answers[i].score, answers[i - 1].score);
  }
}

TEST(PlaceIndex, ScoresOneForTheSameWordsAndNothingForNone) {
  Filled filled;
  const auto answers = filled.ask(filled.places[7]);
  EXPECT_EQ(answers[0].keyframe, 7);
  EXPECT_NEAR(answers[0].score, 1.0F, 0.05F);
  EXPECT_TRUE(filled.ask({}).empty());
}

TEST(PlaceIndex, CountsRareWordsMoreThanCommonOnes) {
  PlaceIndex index(Vocabulary::shipped(), 20, kFeatures);
  for (std::int32_t slot = 0; slot < 20; ++slot) {
    std::vector<std::uint32_t> words(10, static_cast<std::uint32_t>(100 + slot));  // its own
    for (std::uint32_t common = 0; common < 10; ++common) {
      if (slot != 3) words.push_back(common);
    }
    index.add(slot, words);
  }
  index.query(std::vector<std::uint32_t>{1, 103});
  EXPECT_EQ(index.next()->keyframe, 3);
}

TEST(PlaceIndex, LeavesOutWhatTheCallerKnows) {
  Filled filled;
  filled.index.query(filled.places[7]);
  filled.index.leave_out(7);
  while (const auto c = filled.index.next()) EXPECT_NE(c->keyframe, 7);
  EXPECT_EQ(filled.ask(filled.places[7])[0].keyframe, 7) << "only of that query";
}

// Against a plain table, through a long life.
TEST(PlaceIndex, ForgetsExactlyWhatIsRemoved) {
  Filled filled;
  std::map<std::int32_t, std::vector<std::uint32_t>> kept;
  for (std::int32_t slot = 0; slot < kSlots; ++slot) kept[slot] = filled.places[static_cast<std::size_t>(slot)];
  for (int round = 0; round < 3000; ++round) {
    const auto slot = static_cast<std::int32_t>(filled.random() % kSlots);
    if (filled.random() % 2 == 0) {
      filled.index.remove(slot);
      kept.erase(slot);
    } else {
      kept[slot] = random_words(filled.random, static_cast<int>(filled.random() % kFeatures));
      filled.index.add(slot, kept[slot]);
    }
  }
  EXPECT_EQ(filled.index.size(), static_cast<int>(kept.size()));
  Filled fresh;
  for (std::int32_t slot = 0; slot < kSlots; ++slot) fresh.index.remove(slot);
  EXPECT_EQ(fresh.index.size(), 0);
  for (const auto& [slot, words] : kept) fresh.index.add(slot, words);
  for (int q = 0; q < 20; ++q) {
    const auto words = random_words(filled.random, kFeatures);
    const auto lived = filled.ask(words), new_born = fresh.ask(words);
    ASSERT_EQ(lived.size(), new_born.size());
    for (std::size_t i = 0; i < lived.size(); ++i) {
      EXPECT_EQ(lived[i].keyframe, new_born[i].keyframe);
      EXPECT_EQ(lived[i].score, new_born[i].score);
    }
  }
}

TEST(PlaceIndex, AllocatesNothingOnceMade) {
  Filled filled;
  const auto words = random_words(filled.random, kFeatures);
  if (!counting_works()) GTEST_SKIP();
  start_counting();
  for (std::int32_t slot = 0; slot < kSlots; ++slot) {
    filled.index.remove(slot);
    filled.index.add(slot, words);
  }
  filled.index.query(words);
  while (filled.index.next()) {
  }
  EXPECT_EQ(stop_counting().allocations, 0U);
}

TEST(PlaceIndex, TakesOnlyAsManyWordsAsItHasRoomFor) {
  Filled filled;
  filled.index.add(0, random_words(filled.random, 10 * kFeatures));
  const auto answers = filled.ask(random_words(filled.random, 10 * kFeatures));
  EXPECT_LE(answers.size(), static_cast<std::size_t>(kSlots));
}

}  // namespace povslam
