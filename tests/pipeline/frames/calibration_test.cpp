#include "pipeline/frames/calibration.hpp"

#include <gtest/gtest.h>

namespace povslam {

TEST(LevelForwardCamera, LooksAlongTheBodysXWithItsImageUpright) {
  const Rigid3 T_body_camera = level_forward_camera();
  EXPECT_LT((T_body_camera * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitX()).norm(), 1e-15);  // forward
  EXPECT_LT((T_body_camera * Eigen::Vector3d::UnitX() + Eigen::Vector3d::UnitY()).norm(), 1e-15);  // right
  EXPECT_LT((T_body_camera * Eigen::Vector3d::UnitY() + Eigen::Vector3d::UnitZ()).norm(), 1e-15);  // down
}

}  // namespace povslam
