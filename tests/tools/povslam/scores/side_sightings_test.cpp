#include "tools/povslam/scores/side_sightings.hpp"

#include <gtest/gtest.h>

namespace povslam::scores {
namespace {

// A camera in the origin looks along +x at a box whose nearer side is 2 m away; `beside_m`: how far it stands to the
// left.
class Sides : public testing::Test {
 protected:
  Sides() {
    camera_.width = 640, camera_.height = 480;
    camera_.fx = camera_.fy = 300.0;
    camera_.cx = 319.5, camera_.cy = 239.5;
    depth_ = ImageU16(camera_.width, camera_.height);
    T_camera_world_.rotation =
        Eigen::Quaterniond((Eigen::Matrix3d() << 0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0).finished());
  }
  // Depth of what the camera measures of the box's near side and of the one towards its axis.
  void measure(const OrientedBox& box) {
    const double front = box.center_world.x() - 0.5 * box.size_m.x(),
                 right = box.center_world.y() - 0.5 * box.size_m.y();
    for (int v = 0; v < camera_.height; ++v) {
      for (int u = 0; u < camera_.width; ++u) {
        const double slope = -(u - camera_.cx) / camera_.fx;  // y / x
        const double at_front = slope * front;
        const double depth_m = at_front >= right ? front : slope > 0.0 ? right / slope : 0.0;
        depth_.at(u, v) = static_cast<std::uint16_t>(1000.0 * std::min(depth_m, 60.0));
      }
    }
  }
  TrueView view() const { return {0, T_camera_world_, &camera_, &depth_, 1000.0, nullptr}; }

  PinholeCamera camera_;
  ImageU16 depth_;
  Rigid3 T_camera_world_;
};

}  // namespace

TEST_F(Sides, OneFromStraightAheadIsNotEnough) {
  const OrientedBox box{{2.5, 0.0, 0.0}, {1.0, 1.0, 1.0}, 0.0};
  measure(box);
  SideSightings sides(box);
  for (int i = 0; i < 3; ++i) sides.look(view());
  EXPECT_TRUE(sides.seen(1));
  EXPECT_FALSE(sides.seen(0) || sides.seen(2) || sides.seen(3));
  EXPECT_FALSE(sides.two_that_meet());
}

TEST_F(Sides, TwoThatMeetAreSeenFromBesideInThreeFrames) {
  const OrientedBox box{{2.5, 1.8, 0.0}, {1.0, 1.0, 1.0}, 0.0};
  measure(box);
  SideSightings sides(box);
  for (int i = 0; i < 2; ++i) sides.look(view());
  EXPECT_FALSE(sides.two_that_meet());
  sides.look(view());
  EXPECT_TRUE(sides.seen(1) && sides.seen(3));
  EXPECT_TRUE(sides.two_that_meet());
}

TEST_F(Sides, OneThatIsSeenTooFlatlyDoesNotCount) {
  const OrientedBox box{{2.5, 0.8, 0.0}, {1.0, 1.0, 1.0}, 0.0};  // its right side lies 7 degrees off the line of sight
  measure(box);
  SideSightings sides(box);
  for (int i = 0; i < 3; ++i) sides.look(view());
  EXPECT_TRUE(sides.seen(1));
  EXPECT_FALSE(sides.seen(3));
}

}  // namespace povslam::scores
