#include "pipeline/mapping/compare.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "pipeline/mapping/integrate.hpp"
#include "tests/pipeline/mapping/rendered_view.hpp"

namespace povslam {
namespace {

constexpr std::uint16_t kThing = kFirstInstance;
const Box kBox{{-0.3, -0.3, 0.0}, {0.3, 0.3, 0.6}};
const Thing kFloor{Wall{{0.0, 0.0, 1.0}, 0.0}, kStructure};
const Thing kBack{Wall{{0.0, 1.0, 0.0}, 2.0}, kStructure};
const Rigid3 kWorld;
const Rigid3 kEye = looking({0.0, -2.0, 1.0}, {0.0, 0.0, 0.3});

// The box as mapped from all around; its volume's frame is the world's.
Volume mapped_box() {
  Volume volume({.voxel_size_m = 0.05, .truncation_m = 0.4, .max_blocks = 400});
  unsigned seed = 0;
  for (const Rigid3& pose : ring({0.0, 0.0, 0.3}, 2.0, 0.8, 16)) {
    integrate(volume, render({kFloor, {kBox, kThing}}, pose, {.noise = 1.0, .doubt_px = 2, .seed = ++seed}), kThing,
              kWorld, {});
  }
  return volume;
}

DepthView seen(const std::vector<Thing>& things, const Rigid3& eye = kEye) {
  return render(things, eye, {.noise = 1.0, .flying_share = 0.5, .seed = 99});
}

// Not zero while it stands: distances are along the ray, and the model's are means over other rays.
TEST(CompareDistances, GrowsAsTheThingMovesAndIsLargestWhenItLeft) {
  const Volume volume = mapped_box();
  const DistanceComparison same = compare_distances(volume, seen({kFloor, kBack, {kBox, kThing}}), kWorld);
  EXPECT_GT(same.voxels, 500);
  EXPECT_LT(same.mean_difference_m, 0.12);
  double last_m = same.mean_difference_m;
  for (const double shift_m : {-0.2, -0.4}) {  // towards the camera
    const Eigen::Vector3d shift(0.0, shift_m, 0.0);
    const Box moved{kBox.low + shift, kBox.high + shift};
    const auto now = compare_distances(volume, seen({kFloor, kBack, {moved, kThing}}), kWorld);
    EXPECT_GT(now.mean_difference_m, last_m + 0.03) << shift_m;
    last_m = now.mean_difference_m;
  }
  EXPECT_GT(compare_distances(volume, seen({kFloor, kBack}), kWorld).mean_difference_m, 2.0 * same.mean_difference_m);
}

TEST(CompareDistances, FollowsTheVolumeWhereItIsSaidToBe) {
  const Volume volume = mapped_box();
  const Eigen::Vector3d shift(0.2, 0.3, 0.0);
  const Box moved{kBox.low + shift, kBox.high + shift};
  const auto view = seen({kFloor, kBack, {moved, kThing}});
  const Rigid3 there{Eigen::Quaterniond::Identity(), shift};
  EXPECT_LT(compare_distances(volume, view, there).mean_difference_m,
            0.6 * compare_distances(volume, view, kWorld).mean_difference_m);
}

TEST(CompareDistances, HasNothingToCompareWhenHiddenOrOutOfView) {
  const Volume volume = mapped_box();
  const Thing screen{Wall{{0.0, 1.0, 0.0}, -1.4}, kStructure};
  EXPECT_EQ(compare_distances(volume, seen({screen}), kWorld).voxels, 0);
  const Rigid3 away = looking({0.0, -2.0, 1.0}, {0.0, -4.0, 0.3});
  EXPECT_EQ(compare_distances(volume, seen({kFloor, kBack}, away), kWorld).voxels, 0);
}

class LookAt : public testing::Test {
 protected:
  const Volume volume_ = mapped_box();
  const std::vector<SurfacePoint> surface_ = surface_points(volume_, 0.5);
  SurfaceLook look(const std::vector<Thing>& things, const Rigid3& eye = kEye) const {
    return look_at(surface_, seen(things, eye), kWorld, 0.05);
  }
};

TEST_F(LookAt, KnowsTheWholeSurface) {
  EXPECT_GT(surface_.size(), 400U);
  EXPECT_LT(surface_.size(), 2000U);
}

TEST_F(LookAt, AgreesWithWhatStands) {
  const SurfaceLook now = look({kFloor, kBack, {kBox, kThing}});
  EXPECT_GT(now.facing, 150);
  EXPECT_GT(now.agree, 0.93 * now.facing);
  EXPECT_LT(now.seen_through, 0.03 * now.facing);
  EXPECT_LT(now.hidden, 0.05 * now.facing);
}

TEST_F(LookAt, SeesThroughWhatLeft) {
  const SurfaceLook now = look({kFloor, kBack});
  EXPECT_GT(now.seen_through, 0.75 * now.facing);  // not where the floor is near
  EXPECT_EQ(now.hidden, 0);
  EXPECT_GT(now.mean_beyond_m, 0.3);
  EXPECT_LE(now.mean_beyond_m, 1.0);
}

TEST_F(LookAt, SaysHiddenBehindAnotherThing) {
  const Thing screen{Box{{-1.0, -1.1, 0.0}, {0.0, -1.0, 2.0}}, kStructure};  // before its left half
  const SurfaceLook standing = look({kFloor, kBack, screen, {kBox, kThing}});
  EXPECT_GT(standing.hidden, 0.3 * standing.facing);
  EXPECT_LT(standing.seen_through, 0.02 * standing.facing);
  const SurfaceLook left = look({kFloor, kBack, screen});
  EXPECT_GT(left.hidden, 0.3 * left.facing);
  EXPECT_GT(left.seen_through, 0.25 * left.facing);
  EXPECT_LT(left.agree, 0.2 * left.facing);
}

TEST_F(LookAt, SaysOfEachPointWhatItCounts) {
  const Thing screen{Box{{-1.0, -1.1, 0.0}, {0.0, -1.0, 2.0}}, kStructure};
  const DepthView view = seen({kFloor, kBack, screen});
  const SurfaceLook sum = look_at(surface_, view, kWorld, 0.05);
  const std::vector<PointLook> each = look_at_each(surface_, view, kWorld, 0.05);
  ASSERT_EQ(each.size(), surface_.size());
  EXPECT_EQ(std::ranges::count(each, PointLook::agrees), sum.agree);
  EXPECT_EQ(std::ranges::count(each, PointLook::seen_through), sum.seen_through);
  EXPECT_EQ(std::ranges::count(each, PointLook::hidden), sum.hidden);
  for (std::size_t i = 0; i < each.size(); ++i) {
    if (each[i] != PointLook::hidden) continue;
    EXPECT_LT(surface_[i].p_volume.x(), 0.15F) << "the screen is on the left";
  }
}

TEST_F(LookAt, WithoutDepthNothingIsSaid) {
  DepthView view = seen({kFloor, kBack});
  view.depth_m.fill(0.0F);
  const SurfaceLook now = look_at(surface_, view, kWorld, 0.05);
  EXPECT_GT(now.facing, 150);
  EXPECT_EQ(now.agree + now.seen_through + now.hidden, 0);
}

TEST_F(LookAt, LooksOnlyAtWhatFacesTheCameraWithinItsRange) {
  const SurfaceLook behind = look({kFloor, kBack, {kBox, kThing}}, looking({0.0, 1.9, 1.0}, {0.0, 0.0, 0.3}));
  const SurfaceLook front = look({kFloor, kBack, {kBox, kThing}});
  EXPECT_NEAR(behind.facing, front.facing, 0.2 * front.facing);
  EXPECT_LT(front.facing, 0.7 * static_cast<double>(surface_.size()));
  EXPECT_EQ(look({kFloor}, looking({0.0, -6.0, 1.0}, {0.0, 0.0, 0.3})).facing, 0);
}

}  // namespace
}  // namespace povslam
