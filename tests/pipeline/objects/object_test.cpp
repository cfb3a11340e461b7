#include "pipeline/objects/object.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace povslam {
namespace {

constexpr double kVoxel_m = 0.05;

// What a volume's surface shows of one upright face: points in the middle of its voxels.
void add_face(std::vector<SurfacePoint>& surface, const Eigen::Vector3d& corner, const Eigen::Vector3d& along_u,
              const Eigen::Vector3d& along_v, const Eigen::Vector3d& normal) {
  const int u_count = static_cast<int>(along_u.norm() / kVoxel_m + 1e-9),
            v_count = static_cast<int>(along_v.norm() / kVoxel_m + 1e-9);
  for (int u = 0; u < u_count; ++u) {
    for (int v = 0; v < v_count; ++v) {
      const Eigen::Vector3d p = corner + along_u * ((u + 0.5) / u_count) + along_v * ((v + 0.5) / v_count);
      surface.push_back({p.cast<float>(), normal.cast<float>()});
    }
  }
}

const Eigen::Vector3d kX = Eigen::Vector3d::UnitX(), kY = Eigen::Vector3d::UnitY(), kZ = Eigen::Vector3d::UnitZ();

TEST(BoxOfSurface, ReachesTheEndsOfASideThatEndsWithoutAnother) {
  std::vector<SurfacePoint> surface;
  add_face(surface, {0.0, 0.0, 0.0}, 1.2 * kX, 0.8 * kZ, -kY);
  const auto box = box_of_surface(surface, kVoxel_m, 1.0);
  ASSERT_TRUE(box);
  const bool turned = std::abs(box->yaw) > 0.25 * std::numbers::pi;
  EXPECT_NEAR(box->size_m[turned ? 1 : 0], 1.2, 0.011);
  EXPECT_NEAR(box->size_m.z(), 0.8, 0.011);
  EXPECT_NEAR(box->center.z(), 0.4, 0.005);
}

TEST(BoxOfSurface, EndsAtASideThatWasSeen) {
  std::vector<SurfacePoint> surface;
  add_face(surface, {0.0, 0.0, 0.0}, 1.2 * kX, 0.8 * kZ, -kY);
  add_face(surface, {0.0, 0.0, 0.0}, 0.6 * kY, 0.8 * kZ, -kX);
  add_face(surface, {1.2, 0.0, 0.0}, 0.6 * kY, 0.8 * kZ, kX);
  add_face(surface, {0.0, 0.6, 0.0}, 1.2 * kX, 0.8 * kZ, kY);
  add_face(surface, {0.0, 0.0, 0.8}, 1.2 * kX, 0.6 * kY, kZ);
  const auto box = box_of_surface(surface, kVoxel_m, 1.0);
  ASSERT_TRUE(box);
  const bool turned = std::abs(box->yaw) > 0.25 * std::numbers::pi;
  EXPECT_NEAR(box->size_m[turned ? 1 : 0], 1.2, 0.011);
  EXPECT_NEAR(box->size_m[turned ? 0 : 1], 0.6, 0.011);
  EXPECT_NEAR(box->size_m.z(), 0.8, 0.011);
  EXPECT_NEAR(box->center.x(), 0.6, 0.006);
  EXPECT_NEAR(box->center.y(), 0.3, 0.006);
}

TEST(BoxOfSurface, IsAsDeepAsItsSmallerExtentBehindItsOneSide) {
  std::vector<SurfacePoint> surface;
  add_face(surface, {0.0, 0.0, 0.0}, 1.2 * kX, 0.8 * kZ, -kY);
  const auto box = box_of_surface(surface, kVoxel_m, 1.0);
  ASSERT_TRUE(box);
  const bool turned = std::abs(box->yaw) > 0.25 * std::numbers::pi;
  EXPECT_NEAR(box->size_m[turned ? 0 : 1], 0.8, 0.011);
  EXPECT_NEAR(box->center.y(), 0.4, 0.015);
}

TEST(BoxOfSurface, OfTwoPointsIsNothing) {
  const std::vector<SurfacePoint> surface(2);
  EXPECT_FALSE(box_of_surface(surface, kVoxel_m, 1.0));
}

}  // namespace
}  // namespace povslam
