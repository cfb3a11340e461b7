#include "pipeline/base/result.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace povslam {
namespace {

Result<int> half_of(int number) {
  if (number % 2 != 0) return Error{"odd"};
  return number / 2;
}

}  // namespace

TEST(Result, HoldsTheValueOrTheError) {
  EXPECT_TRUE(half_of(8));
  EXPECT_EQ(*half_of(8), 4);
  EXPECT_FALSE(half_of(7));
  EXPECT_EQ(half_of(7).error().message, "odd");
}

TEST(Result, CarriesValuesThatCanOnlyBeMoved) {
  Result<std::unique_ptr<int>> result(std::make_unique<int>(5));
  const std::unique_ptr<int> mine = std::move(*result);
  EXPECT_EQ(*mine, 5);
}

TEST(ResultDeathTest, EndsTheProcessWhenTheWrongSideIsRead) {
  EXPECT_DEATH((void)*half_of(7), "contract failed");
  EXPECT_DEATH((void)half_of(8).error(), "contract failed");
}

}  // namespace povslam
