#include "pipeline/objects/segment_boxes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace povslam {

namespace {

constexpr int kInput_px = 64, kClasses = 3, kLength = 5 + kClasses;
constexpr int kRows = 8 * 8 + 4 * 4 + 2 * 2;

struct Output {
  std::vector<float> rows = std::vector<float>(kRows * kLength, 0.0F);

  // A box at (dx, dy) of the cell, in strides.
  void set(int row, float dx, float dy, float log_width, float log_height, float objectness, int class_index) {
    float* at = rows.data() + row * kLength;
    at[0] = dx;
    at[1] = dy;
    at[2] = log_width;
    at[3] = log_height;
    at[4] = objectness;
    at[5 + class_index] = 0.9F;
  }
};

TEST(DecodeYolox, PlacesABoxByItsCellStrideAndScale) {
  Output output;
  output.set(64 + 4 * 2 + 1, 0.5F, 0.25F, std::log(2.0F), 0.0F, 1.0F, 2);  // stride 16, cell (1, 2)
  const auto boxes = decode_yolox(output.rows, kInput_px, kClasses, 0.5F, {});
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_EQ(boxes[0].class_index, 2);
  EXPECT_FLOAT_EQ(boxes[0].score, 0.9F);
  EXPECT_NEAR(boxes[0].width, 64.0, 1e-4);
  EXPECT_NEAR(boxes[0].height, 32.0, 1e-4);
  EXPECT_NEAR(boxes[0].x, 48.0 - 32.0, 1e-4);
  EXPECT_NEAR(boxes[0].y, 72.0 - 16.0, 1e-4);
}

TEST(DecodeYolox, KeepsTheBetterOfTwoBoxesOfOneClassInOnePlace) {
  Output output;
  output.set(9, 0.0F, 0.0F, 1.0F, 1.0F, 0.6F, 0);
  output.set(10, -1.0F, 0.1F, 1.0F, 1.0F, 0.8F, 0);
  output.set(11, -2.0F, 0.0F, 1.0F, 1.0F, 0.7F, 1);
  const auto boxes = decode_yolox(output.rows, kInput_px, kClasses, 1.0F, {});
  ASSERT_EQ(boxes.size(), 2U);
  EXPECT_FLOAT_EQ(boxes[0].score, 0.72F);
  EXPECT_EQ(boxes[1].class_index, 1) << "another class in the same place is another thing";
}

TEST(DecodeYolox, LeavesOutWhatTheNetworkIsNotSureOf) {
  Output output;
  output.set(9, 0.0F, 0.0F, 1.0F, 1.0F, 0.3F, 0);  // times 0.9
  EXPECT_TRUE(decode_yolox(output.rows, kInput_px, kClasses, 1.0F, {}).empty());
}

TEST(DecodeYolox, TakesNothingFromRowsThatMakeNoSense) {
  Output output;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  output.set(1, nan, 0.0F, 1.0F, 1.0F, 1.0F, 0);
  output.set(2, 0.0F, 0.0F, 200.0F, 1.0F, 1.0F, 0);
  output.set(3, 0.0F, 0.0F, 1.0F, nan, 1.0F, 0);
  output.set(4, 0.0F, 0.0F, 1.0F, 1.0F, nan, 0);
  EXPECT_TRUE(decode_yolox(output.rows, kInput_px, kClasses, 1.0F, {}).empty());
  output.rows.pop_back();
  EXPECT_TRUE(decode_yolox(output.rows, kInput_px, kClasses, 1.0F, {}).empty());
  EXPECT_TRUE(decode_yolox({}, kInput_px, kClasses, 1.0F, {}).empty());
}

}  // namespace

}  // namespace povslam
