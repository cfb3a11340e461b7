#include "pipeline/held_news.hpp"

#include <gtest/gtest.h>

namespace povslam {
namespace {

struct Told {
  TimeNs seen = 0;
  int what = 0;
};

TEST(HeldNews, AreDueAFixedTimeAfterTheirView) {
  HeldNews<Told> news(30, 8);
  ASSERT_TRUE(news.add(std::vector<Told>{{100, 1}, {100, 2}}));
  ASSERT_TRUE(news.add(std::vector<Told>{{120, 3}}));
  EXPECT_EQ(news.due(129).size(), 0U);
  ASSERT_EQ(news.due(130).size(), 2U);
  EXPECT_EQ(news.due(130)[1].what, 2);
  news.drop(2);
  EXPECT_EQ(news.due(149).size(), 0U);
  ASSERT_EQ(news.due(150).size(), 1U);
  EXPECT_EQ(news.due(150)[0].what, 3);
}

TEST(HeldNews, ThatComeLateAreDueAtOnce) {
  HeldNews<Told> news(30, 8);
  ASSERT_TRUE(news.add(std::vector<Told>{{100, 1}}));
  EXPECT_EQ(news.due(500).size(), 1U);
}

TEST(HeldNews, AreKeptWholeOrNotAtAll) {
  HeldNews<Told> news(30, 2);
  EXPECT_FALSE(news.add(std::vector<Told>(3)));
  EXPECT_TRUE(news.all().empty());
  EXPECT_TRUE(news.add(std::vector<Told>(2)));
  EXPECT_FALSE(news.add(std::vector<Told>(1)));
  EXPECT_EQ(news.all().size(), 2U);
}

}  // namespace
}  // namespace povslam
