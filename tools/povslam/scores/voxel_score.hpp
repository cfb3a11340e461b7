// The dense map against true surfaces, as sets of occupied voxels (POV-SLAM, Qian et al., RSS 2023, table of map
// quality; the count of negatives is not defined there: here it is the truth's bounding box).
//
// Voxel k of an axis holds coordinates from (k - 1/2) to (k + 1/2) voxel sizes: shifted by half a cell, so that floors
// and walls at round coordinates lie inside a layer of cells and not on a border that noise decides.
#pragma once

#include <Eigen/Core>
#include <compare>
#include <cstdint>
#include <set>
#include <span>

#include "tools/povslam/scores/ply_file.hpp"

namespace povslam::scores {

struct Voxel {
  std::int32_t x = 0, y = 0, z = 0;
  auto operator<=>(const Voxel&) const = default;
};
using VoxelSet = std::set<Voxel>;

Voxel voxel_at(const Eigen::Vector3d& p_world, double voxel_size_m);
VoxelSet voxels_of_points(std::span<const Eigen::Vector3d> points_world, double voxel_size_m);
// Voxels that a triangle passes through, at samples a tenth of a voxel apart; vertices without any triangle count as
// points.
// An error: more surface than any map of this voxel size could hold (a broken file, or one not in metres).
Result<VoxelSet> voxels_of_mesh(const PlyMesh& mesh, double voxel_size_m);
// Leaves out the layer that holds the floor and what lies below it.
void drop_floor(VoxelSet& voxels, double floor_z_m, double voxel_size_m);

struct VoxelCounts {
  std::size_t true_positive = 0, false_positive = 0, false_negative = 0;
  std::size_t false_positive_in_box = 0, true_negative = 0;  // within the truth's bounding box, padded by one voxel
  std::size_t excused = 0;  // map voxels that hold only true surface too little seen: neither right nor wrong
};

// excused: voxels that are never counted as false positives (may be empty). first_layer: lowest z index that counts.
VoxelCounts score_voxels(const VoxelSet& truth, const VoxelSet& map, const VoxelSet& excused, std::int32_t first_layer);

}  // namespace povslam::scores
