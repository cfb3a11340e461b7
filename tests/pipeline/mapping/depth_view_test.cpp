#include "pipeline/mapping/depth_view.hpp"

#include <gtest/gtest.h>

namespace povslam {
namespace {

RgbdFrame frame_of(int width, int height) {
  RgbdFrame frame;
  frame.stamp = 123;
  frame.depth.resize(width, height);
  frame.color.resize(width, height, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      frame.depth.at(x, y) = static_cast<std::uint16_t>(1000 + x + 2 * y);
      for (int c = 0; c < 3; ++c) frame.color.at(x, y, c) = static_cast<std::uint8_t>(x + 40 * c);
    }
  }
  return frame;
}

TEST(DepthView, IsInMetresAndEmptyOutsideTheRange) {
  const PinholeCamera camera{8, 6, 8.0, 8.0, 3.5, 2.5, {}};
  RgbdFrame frame = frame_of(8, 6);
  frame.depth.at(0, 0) = 0;
  frame.depth.at(1, 0) = 299;
  frame.depth.at(2, 0) = 5001;
  frame.depth.at(3, 0) = 5000;
  frame.depth.at(4, 0) = 300;
  DepthView view;
  const Rigid3 pose{Eigen::Quaterniond::Identity(), {1.0, 2.0, 3.0}};
  DepthViewBuilder(camera, {.min_depth_m = 0.3, .max_depth_m = 5.0}).build(frame, pose, view);
  EXPECT_EQ(view.stamp, 123);
  EXPECT_EQ(view.T_world_camera.translation, pose.translation);
  for (int x = 0; x < 3; ++x) EXPECT_EQ(view.depth_m.at(x, 0), 0.0F);
  EXPECT_NEAR(view.depth_m.at(3, 0), 5.0F, 1e-6F);
  EXPECT_NEAR(view.depth_m.at(4, 0), 0.3F, 1e-6F);
  EXPECT_NEAR(view.depth_m.at(5, 4), 1.013F, 1e-6F);
  EXPECT_EQ(view.color.at(5, 4, 2), 85);
  EXPECT_EQ(view.owner.at(5, 4), kNobody);
}

TEST(DepthView, TakesTheNearestRawPixelOfARectifiedOne) {
  const PinholeCamera camera{160, 120, 140.0, 140.0, 79.5, 59.5, {-0.2, 0.05, 0.001, 0.0, 0.0}};
  const RgbdFrame frame = frame_of(160, 120);
  DepthView view;
  const DepthViewBuilder builder(camera, {.min_depth_m = 0.1, .max_depth_m = 9.0});
  builder.build(frame, {}, view);
  EXPECT_FALSE(view.camera.distorted());
  for (int y = 10; y < 110; y += 7) {
    for (int x = 10; x < 150; x += 7) {
      const auto raw = camera.project({(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0});
      const int u = static_cast<int>(std::lround(raw->x())), v = static_cast<int>(std::lround(raw->y()));
      EXPECT_NEAR(view.depth_m.at(x, y), 0.001F * frame.depth.at(u, v), 1e-6F);
      EXPECT_EQ(view.color.at(x, y, 1), frame.color.at(u, v, 1));
    }
  }
}

TEST(DepthView, LooksOutsideOfTheRawImageAreEmpty) {
  const PinholeCamera camera{160, 120, 140.0, 140.0, 79.5, 59.5, {0.3, 0.0, 0.0, 0.0, 0.0}};  // pincushion
  DepthView view;
  DepthViewBuilder(camera, {}).build(frame_of(160, 120), {}, view);
  EXPECT_EQ(view.depth_m.at(0, 0), 0.0F);
  EXPECT_GT(view.depth_m.at(80, 60), 0.0F);
}

TEST(DepthView, LeavesOutColourThatDoesNotFit) {
  const PinholeCamera camera{8, 6, 8.0, 8.0, 3.5, 2.5, {}};
  RgbdFrame frame = frame_of(8, 6);
  frame.color.resize(4, 3, 3);
  DepthView view;
  DepthViewBuilder(camera, {}).build(frame, {}, view);
  EXPECT_TRUE(view.color.empty());
  EXPECT_GT(view.depth_m.at(3, 3), 0.0F);
}

TEST(DepthView, LabelsMayBeSmallerThanTheImage) {
  const PinholeCamera camera{8, 6, 8.0, 8.0, 3.5, 2.5, {}};
  LabelFrame labels;
  labels.classes.resize(4, 3);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 4; ++x) labels.classes.at(x, y) = static_cast<std::uint8_t>(10 * y + x);
  }
  ImageU8 classes;
  const DepthViewBuilder builder(camera, {});
  builder.rectify_labels(labels, classes);
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 8; ++x) EXPECT_EQ(classes.at(x, y), 10 * (y / 2) + x / 2);
  }
  builder.rectify_labels(LabelFrame{}, classes);
  EXPECT_EQ(classes.at(3, 3), 0);
}

}  // namespace
}  // namespace povslam
