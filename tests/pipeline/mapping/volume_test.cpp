#include "pipeline/mapping/volume.hpp"

#include <gtest/gtest.h>

namespace povslam {
namespace {

// Fills a cube of blocks with the distance to a plane x = offset.
Volume plane_volume(double offset_m) {
  Volume volume({.voxel_size_m = 0.05, .truncation_m = 0.4, .max_blocks = 100});
  for (int k = 0; k < 8; ++k) {
    const int index = volume.allocate({(k & 1) - 1, (k >> 1 & 1) - 1, (k >> 2) - 1});
    VoxelBlock& block = volume.block(index);
    for (std::size_t v = 0; v < kBlockVoxels; ++v) {
      const double x = (8 * block.key.x + static_cast<int>(v % 8) + 0.5) * 0.05;
      block.distance[v] = static_cast<std::int16_t>(std::lround((x - offset_m) / 0.4 * kDistanceUnits));
      block.weight[v] = static_cast<std::uint16_t>(block.key.y < 0 ? 2 * kWeightUnits : 5 * kWeightUnits);
    }
  }
  return volume;
}

TEST(Volume, GivesBackTheBlockItMade) {
  Volume volume({});
  const int index = volume.allocate({3, -4, 5});
  ASSERT_EQ(index, 0);
  EXPECT_EQ(volume.allocate({3, -4, 5}), index);
  EXPECT_EQ(volume.find({3, -4, 5}), index);
  EXPECT_EQ(volume.find({3, -4, 6}), -1);
  EXPECT_EQ(volume.block(index).weight[17], 0);
}

TEST(Volume, RefusesBlocksWhenItIsFull) {
  Volume volume({.voxel_size_m = 0.05, .truncation_m = 0.2, .max_blocks = 2});
  EXPECT_GE(volume.allocate({0, 0, 0}), 0);
  EXPECT_GE(volume.allocate({1, 0, 0}), 0);
  EXPECT_EQ(volume.allocate({2, 0, 0}), -1);
  EXPECT_GE(volume.allocate({1, 0, 0}), 0);
  volume.remove({0, 0, 0});
  EXPECT_GE(volume.allocate({2, 0, 0}), 0);
}

TEST(Volume, FindsAllOthersAfterOneWasRemoved) {
  Volume volume({});
  for (int k = -10; k < 10; ++k) volume.allocate({k, 2 * k, -k});
  volume.remove({-10, -20, 10});
  volume.remove({3, 6, -3});
  EXPECT_EQ(volume.num_blocks(), 18);
  for (int k = -9; k < 10; ++k) {
    const int index = volume.find({k, 2 * k, -k});
    if (k == 3) {
      EXPECT_EQ(index, -1);
      continue;
    }
    ASSERT_GE(index, 0);
    EXPECT_EQ(volume.block(index).key, (BlockKey{k, 2 * k, -k}));
    EXPECT_EQ(volume.key(index), (BlockKey{k, 2 * k, -k}));
  }
}

TEST(Volume, ABlockMadeAgainIsNotMistakenForTheOldOne) {
  Volume volume({});
  const std::uint32_t before = volume.block(volume.allocate({0, 0, 0})).changed;
  volume.remove({0, 0, 0});
  EXPECT_NE(volume.block(volume.allocate({0, 0, 0})).changed, before);
}

TEST(Volume, KeysRoundDownBelowZero) {
  const Volume volume({.voxel_size_m = 0.05, .truncation_m = 0.2, .max_blocks = 1});
  EXPECT_EQ(volume.key_of({0.0, 0.39, 0.41}), (BlockKey{0, 0, 1}));
  EXPECT_EQ(volume.key_of({-0.01, -0.39, -0.41}), (BlockKey{-1, -1, -2}));
}

TEST(Volume, SamplesBetweenVoxelsAndAcrossBlocks) {
  const Volume volume = plane_volume(0.03);
  for (const double x : {-0.2, -0.012, 0.0, 0.024, 0.21}) {
    const auto sample = volume.sample({x, 0.013, -0.17});
    ASSERT_TRUE(sample);
    EXPECT_NEAR(sample->distance_m, x - 0.03, 2e-5);
    EXPECT_NEAR(sample->gradient.x(), 1.0, 1e-3);
    EXPECT_NEAR(sample->gradient.y(), 0.0, 1e-3);
    EXPECT_NEAR(sample->gradient.z(), 0.0, 1e-3);
    EXPECT_DOUBLE_EQ(sample->weight, 2.0);
  }
  EXPECT_DOUBLE_EQ(volume.sample({0.0, 0.1, 0.0})->weight, 5.0);
}

TEST(Volume, HasNoSampleBesideWhatWasNeverSeen) {
  Volume volume = plane_volume(0.03);
  EXPECT_FALSE(volume.sample({0.39, 0.0, 0.0}));
  volume.block(volume.find({0, 0, 0})).weight[0] = 0;
  EXPECT_FALSE(volume.sample({0.03, 0.03, 0.03}));
  EXPECT_TRUE(volume.sample({0.1, 0.1, 0.1}));
}

}  // namespace
}  // namespace povslam
