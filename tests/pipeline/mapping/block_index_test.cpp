#include "pipeline/mapping/block_index.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <tuple>

namespace povslam {
namespace {

TEST(BlockIndex, KnowsWhatAMapKnowsHoweverKeysComeAndGo) {
  std::mt19937 random(5);
  const auto part = [&] { return static_cast<std::int32_t>(random() % 9) - 4; };
  BlockIndex index;
  std::map<std::tuple<int, int, int>, int> truth;
  for (int step = 0; step < 20000; ++step) {
    const BlockKey key{part(), part(), part()};
    const std::tuple place{key.x, key.y, key.z};
    if (random() % 2 == 0) {
      index.set(key, step);
      truth[place] = step;
    } else {
      index.remove(key);
      truth.erase(place);
    }
    const BlockKey asked{part(), part(), part()};
    const auto found = truth.find({asked.x, asked.y, asked.z});
    ASSERT_EQ(index.find(asked), found == truth.end() ? -1 : found->second) << step;
  }
  index.clear();
  EXPECT_EQ(index.find({0, 0, 0}), -1);
}

}  // namespace
}  // namespace povslam
