#include "tools/povslam/scores/visibility.hpp"

#include <gtest/gtest.h>

namespace povslam::scores {
namespace {

// A camera in the origin that looks along z and measured one depth everywhere.
class SurfacePoints : public testing::Test {
 protected:
  SurfacePoints() {
    camera_.width = 64, camera_.height = 48;
    camera_.fx = camera_.fy = 50.0;
    camera_.cx = 31.5, camera_.cy = 23.5;
    depth_ = ImageU16(camera_.width, camera_.height);
    depth_.fill(2000);
  }
  bool sees(const Eigen::Vector3d& p_world, const Eigen::Vector3d& normal_world) const {
    return sees_point(view(), p_world, &normal_world);
  }
  TrueView view() const { return {0, Rigid3{}, &camera_, &depth_, 1000.0, nullptr}; }

  PinholeCamera camera_;
  ImageU16 depth_;
};

const Eigen::Vector3d kTowardsCamera(0.0, 0.0, -1.0), kAway(0.0, 0.0, 1.0), kUp(0.0, -1.0, 0.0);

TEST_F(SurfacePoints, AreSeenWhereTheyWereMeasured) {
  EXPECT_TRUE(sees({0.1, 0.1, 2.0}, kTowardsCamera));
  EXPECT_TRUE(sees({0.1, 0.1, 2.03}, kTowardsCamera));  // 3 sigma
  EXPECT_FALSE(sees({0.1, 0.1, 2.05}, kTowardsCamera));
  EXPECT_FALSE(sees({0.1, 0.1, 1.9}, kTowardsCamera));
}

TEST_F(SurfacePoints, TurnedAwayAreNotSeenHoweverNearToWhatWasMeasured) {
  EXPECT_FALSE(sees({0.1, 0.1, 2.0}, kAway));
  EXPECT_FALSE(sees({0.0, -0.4, 2.0}, kUp));  // a top above the camera: y points down
  EXPECT_TRUE(sees({0.0, 0.4, 2.0}, kUp));
}

TEST_F(SurfacePoints, OnASlantMayBeOffByHalfAPixel) {
  const Eigen::Vector3d slanted = Eigen::Vector3d(1.0, 0.0, -0.5).normalized();
  EXPECT_TRUE(sees({0.0, 0.0, 2.07}, slanted));
  EXPECT_FALSE(sees({0.0, 0.0, 2.07}, kTowardsCamera));
  EXPECT_FALSE(sees({0.0, 0.0, 2.1}, slanted));
}

TEST_F(SurfacePoints, WithoutANormalCountWhicheverWayTheyFace) {
  EXPECT_TRUE(sees_point(view(), {0.1, 0.1, 2.07}, nullptr));
  EXPECT_FALSE(sees_point(view(), {0.1, 0.1, 2.1}, nullptr));
}

}  // namespace
}  // namespace povslam::scores
