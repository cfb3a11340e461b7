#include "pipeline/objects/segment_network.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>

namespace povslam {

namespace {

namespace fs = std::filesystem;

const fs::path kShared = fs::path(POVSLAM_SOURCE_DIR) / ".." / "shared";
const fs::path kModel = kShared / "models/yolox_nano/yolox_nano.onnx";
const fs::path kKitchen = kShared / "data/7scenes_redkitchen_000_399/rgb/000300.jpg";

std::vector<std::uint8_t> read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

ImageU8 rgb(const cv::Mat& bgr) {
  ImageU8 image(bgr.cols, bgr.rows, 3);
  for (int y = 0; y < bgr.rows; ++y) {
    for (int x = 0; x < bgr.cols; ++x) {
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = bgr.at<cv::Vec3b>(y, x)[2 - c];
    }
  }
  return image;
}

TEST(SegmentNetwork, RefusesWhatIsNoNetwork) {
  const std::vector<std::uint8_t> text(1000, 'x');
  const auto broken = SegmentNetwork::load(text, {});
  ASSERT_FALSE(broken);
  EXPECT_THAT(broken.error().message, testing::HasSubstr("OpenCV cannot run the network"));
  const auto empty = SegmentNetwork::load({}, {});
  ASSERT_FALSE(empty);
  EXPECT_THAT(empty.error().message, testing::HasSubstr("empty"));
}

TEST(SegmentNetwork, FindsChairsAndACupInAKitchen) {
  if (!fs::exists(kModel) || !fs::exists(kKitchen)) GTEST_SKIP() << "no model or recording in ../shared";
  auto network = SegmentNetwork::load(read(kModel), {});
  ASSERT_TRUE(network) << network.error().message;
  EXPECT_EQ(network->num_classes(), 80);
  const auto boxes = network->detect(rgb(cv::imread(kKitchen.string())));
  ASSERT_TRUE(boxes) << boxes.error().message;
  // The reference of the model's README: class, score, box.
  const DetectedBox reference[] = {{41, 0.857F, 60, 212, 44, 47},   {56, 0.748F, 156, 178, 154, 59},
                                   {62, 0.564F, 425, 0, 201, 53},   {60, 0.528F, -4, 212, 662, 274},
                                   {56, 0.476F, 494, 200, 148, 75}, {73, 0.467F, 34, 236, 207, 100}};
  for (const DetectedBox& expected : reference) {
    const bool found = std::any_of(boxes->begin(), boxes->end(), [&](const DetectedBox& box) {
      return box.class_index == expected.class_index && intersection_over_union(box, expected) > 0.85F &&
             std::abs(box.score - expected.score) < 0.1F;
    });
    EXPECT_TRUE(found) << "class " << expected.class_index << " at " << expected.x << ", " << expected.y;
  }
}

TEST(SegmentNetwork, TakesGreyImagesAndAnySize) {
  if (!fs::exists(kModel)) GTEST_SKIP() << "no model in ../shared";
  auto network = SegmentNetwork::load(read(kModel), {});
  ASSERT_TRUE(network) << network.error().message;
  for (const auto& [width, height] : {std::pair{1, 1}, {37, 900}, {1280, 3}}) {
    ImageU8 grey(width, height);
    grey.fill(90);
    EXPECT_TRUE(network->detect(grey));
  }
  const auto nothing = network->detect(ImageU8());
  ASSERT_TRUE(nothing);
  EXPECT_TRUE(nothing->empty());
}

}  // namespace

}  // namespace povslam
