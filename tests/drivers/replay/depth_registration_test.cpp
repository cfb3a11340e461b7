#include "drivers/replay/depth_registration.hpp"

#include <gtest/gtest.h>

namespace povslam {

namespace {

constexpr double kScale = 1000.0;

DepthCamera kinect_like() {
  return {{160, 120, 146.0, 146.0, 80.0, 60.0, {}}, {Eigen::Quaterniond::Identity(), {-0.025, 0.0, 0.0}}};
}
const PinholeCamera kColor{160, 120, 131.0, 131.0, 80.0, 60.0, {}};

// Depth that a plane n . p = d (depth frame) has in a camera whose points are p_depth = T * p_camera.
ImageU16 plane_depth(const PinholeCamera& camera, const Rigid3& T_depth_camera, const Eigen::Vector3d& n, double d) {
  ImageU16 image(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = T_depth_camera.rotation * camera.unproject(Eigen::Vector2d(x, y));
      const double z = (d - n.dot(T_depth_camera.translation)) / n.dot(ray);
      image.at(x, y) = static_cast<std::uint16_t>(z * kScale + 0.5);
    }
  }
  return image;
}

}  // namespace

TEST(DepthRegistration, OfTheSameCameraChangesNothing) {
  const ImageU16 depth = plane_depth(kColor, {}, {0.2, 0.1, 1.0}, 2.0);
  ImageU16 registered;
  DepthRegistration({kColor, {}}, kColor, kScale).warp(depth, registered);
  int wrong = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) wrong += std::abs(depth.pixels()[i] - registered.pixels()[i]) > 10;
  EXPECT_EQ(wrong, 0);
}

TEST(DepthRegistration, GivesAPlaneAsTheColorCameraWouldMeasureItWithoutPinholes) {
  const DepthCamera depth_camera = kinect_like();
  const Eigen::Vector3d n(0.5, -0.3, 1.0);
  const ImageU16 depth = plane_depth(depth_camera.camera, {}, n, 1.5);
  const ImageU16 truth = plane_depth(kColor, depth_camera.T_color_depth.inverse(), n, 1.5);
  ImageU16 registered;
  DepthRegistration(depth_camera, kColor, kScale).warp(depth, registered);
  ASSERT_EQ(registered.width(), kColor.width);
  int holes = 0;
  for (int y = 12; y < 108; ++y) {
    for (int x = 12; x < 148; ++x) {
      holes += registered.at(x, y) == 0;
      if (registered.at(x, y) == 0) continue;
      ASSERT_NEAR(registered.at(x, y), truth.at(x, y), 15) << x << ' ' << y;
    }
  }
  EXPECT_EQ(holes, 0);
}

TEST(DepthRegistration, LetsTheNearerSurfaceWin) {
  const DepthCamera depth_camera = kinect_like();
  ImageU16 depth = plane_depth(depth_camera.camera, {}, {0.0, 0.0, 1.0}, 3.0);
  for (int y = 40; y < 80; ++y) {
    for (int x = 60; x < 100; ++x) depth.at(x, y) = 800;
  }
  ImageU16 registered;
  DepthRegistration(depth_camera, kColor, kScale).warp(depth, registered);
  const Eigen::Vector3d p_color(-0.025, 0.0, 0.8);  // the box's middle, seen from the colour camera
  const auto pixel = kColor.project(p_color);
  ASSERT_TRUE(pixel);
  EXPECT_EQ(registered.at(static_cast<int>(pixel->x()), static_cast<int>(pixel->y())), 800);
  for (const std::uint16_t z : registered.pixels()) ASSERT_TRUE(z == 0 || z == 800 || z == 3000) << z;
}

TEST(DepthRegistration, KeepsHolesAndIgnoresWhatFallsOutside) {
  DepthCamera far_off = kinect_like();
  far_off.T_color_depth.translation = {100.0, -100.0, -0.5};
  ImageU16 depth(160, 120);
  depth.fill(400);  // behind the colour camera
  depth.at(3, 3) = 65535;
  ImageU16 registered;
  DepthRegistration(far_off, kColor, kScale).warp(depth, registered);
  for (const std::uint16_t z : registered.pixels()) ASSERT_EQ(z, 0);
}

}  // namespace povslam
