#include "pipeline/frontend/feature_grid.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "tests/support/alloc_counter.hpp"

namespace povslam {
namespace {

struct Points {
  std::vector<float> x, y;
};

Points random_points(int count, float low, float high, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(low, high);
  Points points;
  for (int i = 0; i < count; ++i) {
    points.x.push_back(place(random));
    points.y.push_back(place(random));
  }
  return points;
}

std::multiset<std::int32_t> near(const FeatureGrid& grid, float x, float y, float radius) {
  std::multiset<std::int32_t> found;
  grid.for_each_near(x, y, radius, [&found](std::int32_t i) { found.insert(i); });
  return found;
}

}  // namespace

TEST(FeatureGrid, VisitsAllFeaturesOfAWindowOnceAndFewOthers) {
  const Points points = random_points(500, -20.0F, 330.0F, 1);
  FeatureGrid grid(500, -20.0F, -20.0F, 330.0F, 330.0F);
  grid.build(points.x, points.y);
  const Points windows = random_points(300, -60.0F, 370.0F, 2);
  for (std::size_t w = 0; w < windows.x.size(); ++w) {
    const float x = windows.x[w], y = windows.y[w], radius = 0.5F + 0.2F * static_cast<float>(w);
    const auto found = near(grid, x, y, radius);
    for (std::int32_t i = 0; i < 500; ++i) {
      const float dx = std::abs(points.x[static_cast<std::size_t>(i)] - x),
                  dy = std::abs(points.y[static_cast<std::size_t>(i)] - y);
      if (dx <= radius && dy <= radius) {
        EXPECT_EQ(found.count(i), 1U);
      }
      if (dx > radius + 16.0F || dy > radius + 16.0F) {  // a cell's width
        EXPECT_EQ(found.count(i), 0U);
      }
    }
  }
}

TEST(FeatureGrid, KeepsFeaturesOutsideInItsBorderCells) {
  const std::vector<float> x{-500.0F, 900.0F, 50.0F}, y{50.0F, 50.0F, 1e6F};
  FeatureGrid grid(3, 0.0F, 0.0F, 100.0F, 100.0F);
  grid.build(x, y);
  EXPECT_EQ(near(grid, 1.0F, 50.0F, 2.0F), std::multiset<std::int32_t>{0});
  EXPECT_EQ(near(grid, 99.0F, 50.0F, 2.0F), std::multiset<std::int32_t>{1});
  EXPECT_EQ(near(grid, 50.0F, 50.0F, 1e6F), (std::multiset<std::int32_t>{0, 1, 2}));
}

TEST(FeatureGrid, ForgetsTheFrameBeforeAndAllocatesNothing) {
  if (!counting_works()) GTEST_SKIP() << "the sanitizer owns malloc";
  FeatureGrid grid(500, 0.0F, 0.0F, 320.0F, 240.0F);
  const Points many = random_points(500, 0.0F, 240.0F, 1), few = random_points(3, 0.0F, 240.0F, 2);
  start_counting();
  grid.build(many.x, many.y);
  grid.build(few.x, few.y);
  EXPECT_EQ(stop_counting().allocations, 0U);
  EXPECT_EQ(near(grid, 120.0F, 120.0F, 500.0F), (std::multiset<std::int32_t>{0, 1, 2}));
  grid.build({}, {});
  EXPECT_TRUE(near(grid, 120.0F, 120.0F, 500.0F).empty());
}

}  // namespace povslam
