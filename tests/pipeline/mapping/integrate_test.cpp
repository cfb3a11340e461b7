#include "pipeline/mapping/integrate.hpp"

#include <gtest/gtest.h>

#include "pipeline/mapping/compare.hpp"
#include "tests/pipeline/mapping/rendered_view.hpp"

namespace povslam {
namespace {

constexpr std::uint16_t kThing = kFirstInstance;
const Rigid3 kWorld;

struct Error {
  double mean_m = 0.0, worst_m = 0.0;
  int points = 0;
};
template <class Distance>
Error surface_error(const Volume& volume, const Distance& distance, double min_weight = 0.5) {
  Error error;
  for (const SurfacePoint& point : surface_points(volume, min_weight)) {
    const double off = std::abs(distance(point.p_volume.cast<double>()));
    error.mean_m += off;
    error.worst_m = std::max(error.worst_m, off);
    ++error.points;
  }
  error.mean_m /= std::max(error.points, 1);
  return error;
}

TEST(Integrate, FindsAWallWithinAFractionOfAVoxelInNoise) {
  Volume volume({});
  for (unsigned k = 0; k < 10; ++k) {
    const auto view = render({{Wall{{1.0, 0.0, 0.0}, 2.0}}}, looking({0.0, 0.1 * k, 0.5}, {2.0, 0.0, 0.5}),
                             {.noise = 1.0, .seed = k});
    integrate(volume, view, kStructure, kWorld, {});
  }
  const Error error = surface_error(volume, [](const Eigen::Vector3d& p) { return p.x() - 2.0; });
  EXPECT_GT(error.points, 1000);
  EXPECT_LT(error.mean_m, 0.003);
  EXPECT_LT(error.worst_m, 0.03);
}

TEST(Integrate, FindsABallFromAllAround) {
  const Ball ball{{0.3, -0.2, 0.5}, 0.4};
  for (const double voxel_m : {0.05, 0.02}) {
    Volume volume({.voxel_size_m = voxel_m, .truncation_m = 4.0 * voxel_m, .max_blocks = 4000});
    unsigned seed = 0;
    for (const double height : {1.0, 0.1, -1.0}) {
      for (const Rigid3& pose : ring(ball.centre, 1.5, height, 8)) {
        integrate(volume, render({{ball, kThing}}, pose, {.noise = 1.0, .seed = ++seed}), kThing, kWorld, {});
      }
    }
    const Error error =
        surface_error(volume, [&](const Eigen::Vector3d& p) { return (p - ball.centre).norm() - ball.radius_m; });
    EXPECT_GT(error.points, 300);
    EXPECT_LT(error.mean_m, 0.15 * voxel_m);
    EXPECT_LT(error.worst_m, 0.8 * voxel_m);
  }
}

TEST(Integrate, NormalsPointOutOfTheSurface) {
  const Ball ball{{0.0, 0.0, 0.0}, 0.4};
  Volume volume({});
  for (const Rigid3& pose : ring(ball.centre, 1.5, 0.5, 12)) {
    integrate(volume, render({{ball, kThing}}, pose), kThing, kWorld, {});
  }
  const auto points = surface_points(volume, 0.5);
  ASSERT_GT(points.size(), 300U);
  double mean_cosine = 0.0;
  for (const SurfacePoint& point : points) {
    mean_cosine +=
        static_cast<double>(point.normal.dot(point.p_volume.normalized())) / static_cast<double>(points.size());
  }
  EXPECT_GT(mean_cosine, 0.97);
}

TEST(Integrate, AnObjectsVolumeIsInItsOwnFrame) {
  const Ball ball{{1.0, 2.0, 0.5}, 0.3};
  const Rigid3 T_world_volume{Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ())), ball.centre};
  Volume volume({});
  for (const Rigid3& pose : ring(ball.centre, 1.5, 0.3, 8)) {
    integrate(volume, render({{ball, kThing}}, pose), kThing, T_world_volume, {});
  }
  const Error error = surface_error(volume, [&](const Eigen::Vector3d& p) { return p.norm() - ball.radius_m; });
  EXPECT_GT(error.points, 200);
  EXPECT_LT(error.mean_m, 0.01);
}

TEST(Integrate, TakesSurfacesOfItsOwnerOnly) {
  const std::vector<Thing> things{{Wall{{1.0, 0.0, 0.0}, 3.0}, kStructure}, {Ball{{2.0, 0.0, 0.0}, 0.4}, kThing}};
  const auto view = render(things, looking({0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}), {.doubt_px = 2});
  Volume walls({}), thing({});
  integrate(walls, view, kStructure, kWorld, {});
  integrate(thing, view, kThing, kWorld, {});
  for (const SurfacePoint& point : surface_points(walls, 0.1)) EXPECT_NEAR(point.p_volume.x(), 3.0F, 0.02F);
  for (const SurfacePoint& point : surface_points(thing, 0.1)) EXPECT_LT(point.p_volume.x(), 2.1F);
  EXPECT_GT(surface_points(walls, 0.1).size(), 500U);
  EXPECT_GT(surface_points(thing, 0.1).size(), 50U);
}

TEST(Integrate, AFullVolumeRefusesAndSaysSo) {
  Volume volume({.voxel_size_m = 0.05, .truncation_m = 0.2, .max_blocks = 20});
  const auto view = render({{Wall{{1.0, 0.0, 0.0}, 2.0}}}, looking({0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}));
  const IntegrateReport report = integrate(volume, view, kStructure, kWorld, {});
  EXPECT_EQ(report.blocks_made, 20);
  EXPECT_GT(report.blocks_refused, 0);
  EXPECT_EQ(volume.num_blocks(), 20);
}

TEST(Integrate, FarLooksWeighLessAndWeightIsCapped) {
  const auto weight_at = [](double distance_m, int looks, double max_weight) {
    Volume volume({});
    const auto view = render({{Wall{{1.0, 0.0, 0.0}, distance_m}}}, looking({0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}));
    for (int k = 0; k < looks; ++k) integrate(volume, view, kStructure, kWorld, {.max_weight = max_weight});
    return volume.sample({distance_m, 0.0, 0.0})->weight;
  };
  EXPECT_NEAR(weight_at(1.5, 1, 100.0), 1.0, 1e-9);
  const double sigma_m = std::hypot(0.0025 * 3.9 * 3.9, 0.003);
  EXPECT_NEAR(weight_at(4.0, 1, 100.0), std::pow(kGoodSigma_m / sigma_m, 2.0), 0.03);
  EXPECT_NEAR(weight_at(1.5, 30, 5.0), 5.0, 1e-9);
}

TEST(Integrate, ColoursTheSurface) {
  Volume volume({});
  const auto view =
      render({{Wall{{1.0, 0.0, 0.0}, 2.0}, kStructure, {200, 100, 50}}}, looking({0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}));
  integrate(volume, view, kStructure, kWorld, {});
  const int index = volume.find(volume.key_of({1.99, 0.1, 0.1}));
  ASSERT_GE(index, 0);
  const VoxelBlock& block = volume.block(index);
  const std::size_t voxel = 39 % 8 + 8 * (2 + 8 * 2);
  EXPECT_EQ(block.color[3 * voxel], 200);
  EXPECT_EQ(block.color[3 * voxel + 1], 100);
  EXPECT_EQ(block.color[3 * voxel + 2], 50);
}

TEST(Integrate, DoesWithoutColourAndWithGrey) {
  auto view = render({{Wall{{1.0, 0.0, 0.0}, 2.0}}}, looking({0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}));
  view.color.resize(320, 240, 1);
  view.color.fill(77);
  Volume grey({}), none({});
  integrate(grey, view, kStructure, kWorld, {});
  view.color.resize(0, 0);
  integrate(none, view, kStructure, kWorld, {});
  const std::size_t voxel = 39 % 8 + 8 * (2 + 8 * 2);
  EXPECT_EQ(grey.block(grey.find({4, 0, 0})).color[3 * voxel + 2], 77);
  EXPECT_EQ(none.block(none.find({4, 0, 0})).color[3 * voxel + 2], 0);
  EXPECT_EQ(grey.block(grey.find({4, 0, 0})).distance, none.block(none.find({4, 0, 0})).distance);
}

TEST(Integrate, AViewOfNothingChangesNothing) {
  Volume volume({});
  const Rigid3 pose = looking({0.0, 0.0, 0.0}, {1.0, 0.0, 0.0});
  integrate(volume, render({{Wall{{1.0, 0.0, 0.0}, 2.0}}}, pose), kStructure, kWorld, {});
  const std::uint32_t changed = volume.block(0).changed;
  const IntegrateReport report = integrate(volume, render({}, pose), kStructure, kWorld, {});
  EXPECT_EQ(report.blocks_in_view, 0);
  EXPECT_EQ(volume.block(0).changed, changed);
}

}  // namespace
}  // namespace povslam
