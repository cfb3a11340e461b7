#include "pipeline/structure_anchors.hpp"

#include <gtest/gtest.h>

namespace povslam {
namespace {

constexpr VolumeOptions kOptions{0.05, 0.2, 4000};

// A wall at x = `x`, seen from the origin's side, from y = y0 to y1.
void build_wall(Volume& volume, double x, double y0, double y1) {
  for (double y = y0 + 0.01; y < y1; y += 0.4) {
    for (double z = 0.01; z < 0.8; z += 0.4) {
      for (const double ahead : {-0.19, 0.19}) {
        const int index = volume.allocate(volume.key_of({x + ahead, y, z}));
        ASSERT_GE(index, 0);
        VoxelBlock& block = volume.block(index);
        for (int v = 0; v < kBlockVoxels; ++v) {
          const double p_x = (block.key.x * kBlockEdge + v % kBlockEdge + 0.5) * kOptions.voxel_size_m;
          if (std::abs(p_x - x) > 0.2) continue;
          block.distance[static_cast<std::size_t>(v)] = static_cast<std::int16_t>((x - p_x) / 0.2 * kDistanceUnits);
          block.weight[static_cast<std::size_t>(v)] = 10 * kWeightUnits;
        }
        volume.mark_changed(index);
      }
    }
  }
}

double distance_at(const Volume& volume, const Eigen::Vector3d& p) {
  const auto sample = volume.sample(p);
  return sample ? sample->distance_m : 9.0;
}

TEST(StructureAnchors, CarryWhatHangsOnAMovedKeyframeAndNothingElse) {
  Volume volume(kOptions);
  StructureAnchors anchors;
  build_wall(volume, 2.0, 0.0, 1.6);
  anchors.note(volume, 1);
  build_wall(volume, 5.0, 0.0, 1.6);
  anchors.note(volume, 2);
  const KeyframeMotion motions[] = {
      {2, {Eigen::Quaterniond(Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitZ())), {-0.4, 0.1, 0.0}}}};
  EXPECT_GT(anchors.carry(volume, motions), 0);
  EXPECT_NEAR(distance_at(volume, {2.0, 0.8, 0.4}), 0.0, 0.005) << "it hung on keyframe 1";
  int seen = 0;
  for (double y = 0.2; y < 1.4; y += 0.05) {
    const Eigen::Vector3d p = motions[0].T_new_old * Eigen::Vector3d(5.0, y, 0.4);
    const double distance = distance_at(volume, p);
    if (distance > 8.0) continue;
    EXPECT_NEAR(distance, 0.0, 0.035) << y;
    ++seen;
  }
  EXPECT_GE(seen, 20) << "and the wall is whole but for seams";
  EXPECT_GT(distance_at(volume, {5.0, 0.8, 0.4}), 0.1) << "nothing is left where it was";
}

TEST(StructureAnchors, CarryAgainFromWhereItIs) {
  Volume volume(kOptions);
  StructureAnchors anchors;
  build_wall(volume, 2.0, 0.0, 1.6);
  anchors.note(volume, 7);
  const KeyframeMotion there[] = {{7, {Eigen::Quaterniond::Identity(), {0.5, 0.0, 0.0}}}};
  const KeyframeMotion back[] = {{7, {Eigen::Quaterniond::Identity(), {-0.5, 0.0, 0.0}}}};
  EXPECT_GT(anchors.carry(volume, there), 0);
  EXPECT_NEAR(distance_at(volume, {2.5, 0.8, 0.4}), 0.0, 0.005);
  EXPECT_GT(anchors.carry(volume, back), 0);
  EXPECT_NEAR(distance_at(volume, {2.0, 0.8, 0.4}), 0.0, 0.005);
}

TEST(StructureAnchors, LeaveWhatMovesByLessThanAVoxel) {
  Volume volume(kOptions);
  StructureAnchors anchors;
  build_wall(volume, 2.0, 0.0, 0.8);
  anchors.note(volume, 1);
  const KeyframeMotion motions[] = {{1, {Eigen::Quaterniond::Identity(), {0.03, 0.0, 0.0}}}};
  EXPECT_EQ(anchors.carry(volume, motions), 0);
}

}  // namespace
}  // namespace povslam
