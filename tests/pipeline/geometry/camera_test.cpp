#include "pipeline/geometry/camera.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <limits>
#include <ostream>

#include "tests/support/random_geometry.hpp"

namespace povslam {
namespace {

// The TUM benchmark's published calibrations of its three cameras (the last delivers rectified images).
const PinholeCamera kTum1{640, 480, 517.3, 516.5, 318.6, 255.3, {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}};
const PinholeCamera kTum2{640, 480, 520.9, 521.0, 325.1, 249.7, {0.2312, -0.7849, -0.0033, -0.0001, 0.9172}};
const PinholeCamera kTum3{640, 480, 535.4, 539.2, 320.1, 247.6, {}};
const PinholeCamera kBarrel{640, 480, 400.0, 400.0, 319.5, 239.5, {-0.3, 0.08, 0.001, -0.001, 0.0}};

}  // namespace

void PrintTo(const PinholeCamera& camera, std::ostream* out) {
  *out << camera.width << " x " << camera.height << ", fx " << camera.fx;
}

class EveryCamera : public ::testing::TestWithParam<PinholeCamera> {};
INSTANTIATE_TEST_SUITE_P(Presets, EveryCamera, ::testing::Values(kTum1, kTum2, kTum3, kBarrel));

TEST_P(EveryCamera, ProjectsWhatItUnprojectedAtEveryPixelOfTheImageAndItsBorder) {
  const PinholeCamera& camera = GetParam();
  double worst_px = 0.0;
  for (int y = -8; y < camera.height + 8; ++y) {
    for (int x = -8; x < camera.width + 8; ++x) {
      const Eigen::Vector2d pixel(x, y);
      const auto again = camera.project(2.5 * camera.unproject(pixel));
      ASSERT_TRUE(again) << x << " " << y;
      worst_px = std::max(worst_px, (*again - pixel).norm());
    }
  }
  EXPECT_LT(worst_px, 1e-6);
}

TEST_P(EveryCamera, SeesPointsOfARayAtOnePixel) {
  const Eigen::Vector3d ray(0.3, -0.2, 1.0);
  EXPECT_LT((*GetParam().project(0.5 * ray) - *GetParam().project(7.0 * ray)).norm(), 1e-10);
}

TEST_P(EveryCamera, RectifiesToTheUndistortedPinhole) {
  const PinholeCamera& camera = GetParam();
  PinholeCamera pinhole = camera;
  pinhole.distortion = {};
  const Eigen::Vector3d p_camera(0.4, 0.3, 1.2);
  EXPECT_LT((camera.rectify(*camera.project(p_camera)) - *pinhole.project(p_camera)).norm(), 1e-6);
}

TEST_P(EveryCamera, RefusesWhatIsNotInFront) {
  EXPECT_FALSE(GetParam().project({0.1, 0.1, 0.0}));
  EXPECT_FALSE(GetParam().project({0.1, 0.1, -1.0}));
  EXPECT_FALSE(GetParam().project({0.1, 0.1, std::numeric_limits<double>::quiet_NaN()}));
  EXPECT_FALSE(GetParam().project({1.0, 1.0, 1e-300}));
}

TEST_P(EveryCamera, UndistortsAnythingToFiniteNumbers) {
  for (const double radius : {1.0, 3.0, 10.0, 1e3}) {
    EXPECT_TRUE(GetParam().undistort({radius, -0.7 * radius}).allFinite()) << radius;
  }
}

RC_GTEST_PROP(PinholeCamera, ProjectionMovesAsItsDerivativeSays, ()) {
  const Eigen::Vector3d p = testing::random_vector(1.0) + Eigen::Vector3d(0.0, 0.0, 3.0);
  const Eigen::Vector3d step = 1e-6 * testing::random_axis();
  const Eigen::Vector2d moved = (*kTum3.project(p + step) - *kTum3.project(p - step)) / 2.0;
  const double z = p.z();
  Eigen::Matrix<double, 2, 3> J;
  J << kTum3.fx / z, 0.0, -kTum3.fx * p.x() / (z * z), 0.0, kTum3.fy / z, -kTum3.fy * p.y() / (z * z);
  RC_ASSERT((moved - J * step).norm() < 1e-9);
}

TEST(PinholeCamera, DistortsAsTheBrownConradyModelSays) {
  PinholeCamera camera = kTum3;
  camera.distortion = {0.1, 0.01, 0.002, 0.003, 0.0005};  // at x = 1, y = 2: r2 = 5
  const double radial = 1.0 + 0.1 * 5.0 + 0.01 * 25.0 + 0.0005 * 125.0;
  const Eigen::Vector2d expected(radial + 2.0 * 0.002 * 2.0 + 0.003 * (5.0 + 2.0),
                                 2.0 * radial + 0.002 * (5.0 + 8.0) + 2.0 * 0.003 * 2.0);
  EXPECT_LT((camera.distort({1.0, 2.0}) - expected).norm(), 1e-14);
}

TEST(PinholeCamera, DoesNotSeePointsFoldedBackByTheLensModel) {
  const PinholeCamera camera{640, 480, 400.0, 400.0, 319.5, 239.5, {-0.3, 0.0, 0.0, 0.0, 0.0}};
  EXPECT_TRUE(camera.project({1.0, 0.0, 1.0}));   // 1 - 0.9 r^2 is still positive
  EXPECT_FALSE(camera.project({1.5, 0.0, 1.0}));  // would land inside the image again, at 514 px
  for (const double k3 : {0.0, 0.01}) {           // models that grow again at r = 3, but folded on the way
    const PinholeCamera turning{640, 480, 400.0, 400.0, 319.5, 239.5, {-0.55, 0.1, 0.0, 0.0, k3}};
    EXPECT_TRUE(turning.project({0.8, 0.0, 1.0})) << k3;
    EXPECT_FALSE(turning.project({3.0, 0.0, 1.0})) << k3;
  }
}

TEST(PinholeCamera, ContainsItsCornerPixelsAndNothingBeyond) {
  EXPECT_TRUE(kTum1.contains({0.0, 0.0}));
  EXPECT_TRUE(kTum1.contains({639.0, 479.0}));
  EXPECT_FALSE(kTum1.contains({639.1, 0.0}));
  EXPECT_FALSE(kTum1.contains({-0.1, 0.0}));
  EXPECT_FALSE(kTum1.contains({std::numeric_limits<double>::quiet_NaN(), 0.0}));
}

}  // namespace povslam
