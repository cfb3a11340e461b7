#include "tools/povslam/scores/voxel_score.hpp"

#include <gtest/gtest.h>

#include "tools/povslam/scores/scene_report.hpp"

namespace povslam::scores {
namespace {

// A horizontal square from (0, 0) to (edge, edge) at height z, two triangles.
PlyMesh square(double edge_m, double z_m) {
  PlyMesh mesh;
  mesh.vertices = {{0.0, 0.0, z_m}, {edge_m, 0.0, z_m}, {edge_m, edge_m, z_m}, {0.0, edge_m, z_m}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

}  // namespace

TEST(VoxelScore, CellsAreShiftedByHalfSoThatRoundCoordinatesLieInside) {
  EXPECT_EQ(voxel_at({0.0, 0.0, 0.0}, 0.2), (Voxel{0, 0, 0}));
  EXPECT_EQ(voxel_at({0.09, -0.09, 0.19}, 0.2), (Voxel{0, 0, 1}));
  EXPECT_EQ(voxel_at({0.11, -0.11, -0.31}, 0.2), (Voxel{1, -1, -2}));
}

TEST(VoxelScore, ASquareOfOneMetreFillsSixBySixCells) {
  const Result<VoxelSet> voxels = voxels_of_mesh(square(1.0, 0.4), 0.2);
  ASSERT_TRUE(voxels);
  EXPECT_EQ(voxels->size(), 36u);
  for (const Voxel& voxel : *voxels) EXPECT_EQ(voxel.z, 2);
}

TEST(VoxelScore, CountsByHand) {
  const VoxelSet truth{{0, 0, 1}, {1, 0, 1}, {2, 0, 1}};
  const VoxelSet map{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {9, 9, 9}};
  const VoxelCounts counts = score_voxels(truth, map, {}, 1);
  EXPECT_EQ(counts.true_positive, 2u);
  EXPECT_EQ(counts.false_positive, 2u);
  EXPECT_EQ(counts.false_negative, 1u);
  EXPECT_EQ(counts.false_positive_in_box, 1u);
  // Padded box: x -1..3, y -1..1, z 1..2 (the floor's layer 0 does not count) = 30 cells, 3 of them true, 1 false.
  EXPECT_EQ(counts.true_negative, 26u);
}

TEST(VoxelScore, AnExcusedCellIsNeitherRightNorWrong) {
  const VoxelCounts counts = score_voxels({{0, 0, 1}}, {{0, 0, 1}, {1, 0, 1}}, {{1, 0, 1}}, 1);
  EXPECT_EQ(counts.false_positive, 0u);
  EXPECT_EQ(counts.excused, 1u);
  EXPECT_EQ(counts.true_negative, 3u * 3u * 2u - 2u);
}

TEST(VoxelScore, TheFloorAndWhatIsBelowIsLeftOut) {
  VoxelSet voxels{{0, 0, -1}, {0, 0, 0}, {0, 0, 1}};
  drop_floor(voxels, 0.03, 0.2);
  EXPECT_EQ(voxels, (VoxelSet{{0, 0, 1}}));
}

TEST(VoxelScore, OnlySurfaceSeenOftenEnoughIsAskedFor) {
  PlyMesh surface;
  surface.vertices = {{0.0, 0.0, 1.0}, {1.0, 0.0, 1.0}, {2.0, 0.0, 1.0}};
  PlyMesh map;
  map.vertices = {{0.0, 0.0, 1.0}, {2.0, 0.0, 1.0}};
  const auto json = report_voxels(surface, {3, 3, 2}, map, Rigid3{}, {});
  ASSERT_TRUE(json);
  EXPECT_EQ(json->at("recall"), 0.5);
  EXPECT_EQ(json->at("precision"), 0.5);
  EXPECT_EQ(json->at("unseen_true_surface_excused").at("precision"), 1.0);
}

TEST(VoxelScore, AMapMadeWithTruePosesCanBeTheReference) {
  const auto json = report_voxels_against_map(square(1.0, 0.4), square(1.0, 0.4), Rigid3{}, {});
  ASSERT_TRUE(json);
  EXPECT_EQ(json->at("precision"), 1.0);
  EXPECT_EQ(json->at("recall"), 1.0);
  EXPECT_EQ(json->at("false_positive_rate"), 0.0);
}

TEST(VoxelScore, AMeshThatIsNotInMetresIsAnErrorAndNotAHang) {
  EXPECT_FALSE(voxels_of_mesh(square(9999.0, 0.4), 0.02));
}

}  // namespace povslam::scores
