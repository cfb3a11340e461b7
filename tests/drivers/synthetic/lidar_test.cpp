#include "drivers/synthetic/lidar.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "drivers/synthetic/surface.hpp"
#include "tests/drivers/synthetic/support.hpp"

namespace povslam::synthetic {

TEST(Lidar, EachPointLiesWhereItsBeamMeetsTheWorldAtItsOwnTime) {
  SyntheticOptions options = small_options("aisle", 2);
  options.noise = 0.0;
  const World world = make_world(options);
  Lidar lidar(world);
  LidarFrame scan;
  lidar.scan(7.0, scan);
  ASSERT_GT(scan.points.size(), 9000U);
  float before_s = 0.0F;
  for (std::size_t i = 0; i < scan.points.size(); i += 7) {
    const LidarPoint& point = scan.points[i];
    EXPECT_GE(point.t_offset_s, before_s);
    EXPECT_LT(point.t_offset_s, 0.1F);
    before_s = point.t_offset_s;
    const Eigen::Vector3d p_lidar(point.x, point.y, point.z);
    const Rigid3 T_world_lidar =
        world.T_world_body(7.0 + static_cast<double>(point.t_offset_s)) * RobotMotion::T_body_lidar();
    const double range_m = brute_force_range_m(world.scene(), 7.0, T_world_lidar.translation,
                                               T_world_lidar.rotation * p_lidar.normalized());
    EXPECT_NEAR(range_m, p_lidar.norm(), 1e-3);
  }
}

TEST(FinalSurface, LiesOnTheObjectsWhereTheyEndUp) {
  const World world = make_world(small_options("boxsim", 2));
  const std::vector<SurfacePoint> surface = final_surface(world.scene(), 0.01);
  double area_m2 = 0.0;
  for (const Object& object : world.scene().objects) {
    const Eigen::Vector3d& s = object.size_m;
    area_m2 += s.x() * s.y() + 2.0 * s.z() * (s.x() + s.y());  // without the underside
  }
  EXPECT_NEAR(static_cast<double>(surface.size()) * 0.01 * 0.01, area_m2, 0.1 * area_m2);
  for (std::size_t i = 0; i < surface.size(); i += 17) {
    EXPECT_NEAR(surface[i].normal.norm(), 1.0F, 1e-5F);
    double nearest = 1.0;
    for (const Object& object : world.scene().objects) {
      const Eigen::Matrix3d R_object_world =
          Eigen::AngleAxisd(-object.after.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      const Eigen::Vector3d p_object = R_object_world * (surface[i].at.cast<double>() - object.after.position);
      nearest = std::min(nearest, std::abs((p_object.cwiseAbs() - 0.5 * object.size_m).maxCoeff()));
    }
    EXPECT_LT(nearest, 1e-5);
  }
}

}  // namespace povslam::synthetic
