#include "pipeline/objects/name_segments.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace povslam {

namespace {

constexpr int kCup = 41, kTable = 60;

void paint(ImageU16& image, int x, int y, int width, int height, int instance) {
  for (int row = y; row < y + height; ++row) {
    for (int column = x; column < x + width; ++column) image.at(column, row) = static_cast<std::uint16_t>(instance);
  }
}

// Segment 0, a table, with segment 1, a cup, on it; all else is the wall.
ImageU16 table_and_cup() {
  ImageU16 image(200, 100);
  image.fill(kStructure);
  paint(image, 20, 40, 160, 50, kFirstInstance);
  paint(image, 50, 50, 20, 20, kFirstInstance + 1);
  return image;
}

TEST(NameSegments, NamesEachSegmentByTheSmallestBoxThatHoldsIt) {
  const DetectedBox boxes[] = {{kTable, 0.9F, 18, 38, 164, 54}, {kCup, 0.6F, 48, 48, 24, 24}};
  const auto names = name_segments(boxes, table_and_cup(), 2, {});
  ASSERT_EQ(names.size(), 2U);
  EXPECT_EQ(names[0].class_index, kTable);
  EXPECT_EQ(names[1].class_index, kCup);
  EXPECT_FLOAT_EQ(names[1].score, 0.6F);
}

TEST(NameSegments, DoesNotCallACupATableBecauseItsOwnBoxIsMissing) {
  const DetectedBox boxes[] = {{kTable, 0.9F, 18, 38, 164, 54}};
  const auto names = name_segments(boxes, table_and_cup(), 2, {});
  EXPECT_EQ(names[0].class_index, kTable);
  EXPECT_EQ(names[1].class_index, -1);
}

TEST(NameSegments, NamesNoSegmentThatReachesFarOutOfTheBox) {
  const DetectedBox boxes[] = {{kTable, 0.9F, 0, 0, 100, 100}};
  EXPECT_EQ(name_segments(boxes, table_and_cup(), 2, {})[0].class_index, -1);
}

TEST(NameSegments, NeverNamesStructure) {
  ImageU16 wall(200, 100);
  wall.fill(kStructure);
  const DetectedBox boxes[] = {{kTable, 0.9F, 0, 0, 200, 100}};
  EXPECT_TRUE(name_segments(boxes, wall, 0, {}).empty());
}

TEST(NameSegments, LooksAtNothingOutsideOfTheImage) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const DetectedBox boxes[] = {{kTable, 0.9F, -1e9F, -1e9F, 2e9F, 2e9F},
                               {kCup, 0.9F, nan, 0, 10, 10},
                               {kCup, 0.9F, 300, 300, 10, 10},
                               {kCup, 0.9F, 50, 50, -5, 10}};
  const auto names = name_segments(boxes, table_and_cup(), 2, {});
  EXPECT_EQ(names[0].class_index, kTable);
  EXPECT_EQ(names[1].class_index, -1);
}

}  // namespace

}  // namespace povslam
