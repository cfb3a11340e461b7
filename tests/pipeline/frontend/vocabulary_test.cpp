#include "pipeline/frontend/vocabulary.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <set>
#include <vector>

#include "tests/pipeline/frontend/made_frame.hpp"

namespace povslam {
namespace {

// Two words a level: all zeros against all ones, then the upper half of the bits.
struct Bytes {
  explicit Bytes(std::uint32_t levels) {
    std::vector<Descriptor> nodes{{0, 0, 0, 0}, {~0ULL, ~0ULL, ~0ULL, ~0ULL}};
    if (levels == 2) {
      nodes.insert(nodes.end(), {{0, 0, 0, 0}, {0, 0, ~0ULL, ~0ULL}, {~0ULL, ~0ULL, 0, 0}, nodes[1]});
    }
    const std::size_t words = std::size_t{1} << levels;
    storage.resize((sizeof(VocabularyHeader) + nodes.size() * sizeof(Descriptor) + words) / 8 + 1);
    size = sizeof(VocabularyHeader) + nodes.size() * sizeof(Descriptor) + words;
    std::memcpy(data() + sizeof(VocabularyHeader), nodes.data(), nodes.size() * sizeof(Descriptor));
    for (std::size_t w = 0; w < words; ++w) data()[size - words + w] = static_cast<std::byte>(24 * w);
    const VocabularyHeader header{kVocabularyMagic, 2, levels,
                                  vocabulary_fingerprint(2, levels, span().subspan(sizeof(VocabularyHeader)))};
    std::memcpy(data(), &header, sizeof header);
  }
  std::byte* data() { return reinterpret_cast<std::byte*>(storage.data()); }
  std::span<const std::byte> span() { return {data(), size}; }
  std::vector<std::uint64_t> storage;
  std::size_t size = 0;
};

Descriptor with_flips(Descriptor d, int count, std::mt19937_64& random) {
  for (int i = 0; i < count; ++i) {
    const std::uint64_t bit = random() % 256;
    d[bit / 64] ^= std::uint64_t{1} << (bit % 64);
  }
  return d;
}

}  // namespace

TEST(Vocabulary, DescendsToTheNearestLeaf) {
  Bytes bytes(2);
  const auto vocabulary = Vocabulary::view(bytes.span());
  ASSERT_TRUE(vocabulary) << vocabulary.error().message;
  EXPECT_EQ(vocabulary->num_words(), 4U);
  EXPECT_EQ(vocabulary->word({0, 1, 2, 4}), 0U);
  EXPECT_EQ(vocabulary->word({0, 0, ~0ULL, ~7ULL}), 1U);
  EXPECT_EQ(vocabulary->word({~0ULL, ~1ULL, 3, 0}), 2U);
  EXPECT_EQ(vocabulary->word({~0ULL, ~0ULL, ~3ULL, ~0ULL}), 3U);
  EXPECT_FLOAT_EQ(vocabulary->idf(3), 3.0F);
}

TEST(Vocabulary, NamesTheWordsOfManyLooksAtOnce) {
  const auto looks = made::looks(50, 3);
  std::vector<std::uint32_t> words(looks.size());
  Vocabulary::shipped().words(looks, words);
  for (std::size_t i = 0; i < looks.size(); ++i) EXPECT_EQ(words[i], Vocabulary::shipped().word(looks[i]));
}

TEST(Vocabulary, ShipsThousandsOfWordsThatLooksSpreadOver) {
  const Vocabulary& vocabulary = Vocabulary::shipped();
  EXPECT_GE(vocabulary.num_words(), 1000U);
  std::set<std::uint32_t> words;
  for (const Descriptor& look : made::looks(500, 7)) words.insert(vocabulary.word(look));
  EXPECT_GT(words.size(), 100U);
  EXPECT_NE(vocabulary.fingerprint(), 0U);
}

TEST(Vocabulary, GivesSimilarLooksTheSameWordOften) {
  std::mt19937_64 random(5);
  int same = 0, chance = 0, count = 0;
  const auto looks = made::looks(400, 11);
  for (std::size_t i = 1; i < looks.size(); ++i, ++count) {
    const std::uint32_t word = Vocabulary::shipped().word(looks[i]);
    same += Vocabulary::shipped().word(with_flips(looks[i], 10, random)) == word ? 1 : 0;
    chance += Vocabulary::shipped().word(looks[i - 1]) == word ? 1 : 0;
  }
  EXPECT_GT(same, 5 * chance + count / 10) << "of " << count;
}

TEST(Vocabulary, RefusesWhatIsNone) {
  Bytes bytes(2);
  EXPECT_FALSE(Vocabulary::view({}));
  EXPECT_FALSE(Vocabulary::view(bytes.span().first(40)));
  EXPECT_FALSE(Vocabulary::view(bytes.span().first(bytes.size - 1)));
  EXPECT_FALSE(Vocabulary::view(bytes.span().subspan(1)));
  for (std::size_t at = 0; at < bytes.size; ++at) {
    bytes.data()[at] ^= std::byte{4};
    EXPECT_FALSE(Vocabulary::view(bytes.span())) << "byte " << at;
    bytes.data()[at] ^= std::byte{4};
  }
  EXPECT_TRUE(Vocabulary::view(bytes.span()));
}

}  // namespace povslam
