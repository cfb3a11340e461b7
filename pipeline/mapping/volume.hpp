// A truncated signed distance field with colour on sparse blocks of 8 x 8 x 8 voxels, in the frame of its owner (an
// object's, or the world's). Distance is positive in front of the surface, towards whoever looked.
// Memory is bounded: a full volume refuses new blocks and says how many.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "pipeline/mapping/block_index.hpp"

namespace povslam {

struct VolumeOptions {
  double voxel_size_m = 0.05;  // at least 0.002
  double truncation_m = 0.20;
  int max_blocks = 40000;
};

inline constexpr int kBlockEdge = 8;  // voxels
inline constexpr int kBlockVoxels = kBlockEdge * kBlockEdge * kBlockEdge;

struct VoxelBlock {  // voxel index: x + 8 * (y + 8 * z)
  BlockKey key;
  std::array<std::int16_t, kBlockVoxels> distance{};  // truncation_m / kDistanceUnits
  std::array<std::uint16_t, kBlockVoxels> weight{};   // kWeightUnits = one good look; 0: never seen
  std::array<std::uint8_t, 3 * kBlockVoxels> color{};
  std::uint32_t changed = 0;  // another with each change, also if removed and made again: for meshes and the store
};
inline constexpr int kDistanceUnits = 32000;
inline constexpr int kWeightUnits = 64;

class Volume {
 public:
  explicit Volume(const VolumeOptions& options);

  const VolumeOptions& options() const { return options_; }
  int num_blocks() const { return static_cast<int>(blocks_.size()); }
  VoxelBlock& block(int index) { return *blocks_[static_cast<std::size_t>(index)]; }
  const VoxelBlock& block(int index) const { return *blocks_[static_cast<std::size_t>(index)]; }
  const BlockKey& key(int index) const { return keys_[static_cast<std::size_t>(index)]; }
  int find(const BlockKey& key) const;  // -1: not there
  int allocate(const BlockKey& key);    // found or made (all weights 0); -1: full
  void remove(const BlockKey& key);     // indices of other blocks may change
  void clear();
  void mark_changed(int index) { block(index).changed = ++changes_; }
  BlockKey key_of(const Eigen::Vector3d& p_volume) const;

  struct Sample {
    double distance_m = 0.0;
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  // of the distance, per metre
    double weight = 0.0;                                 // looks, the least of the eight voxels around
  };
  // Trilinear; nothing where one of the eight voxels around was never seen.
  std::optional<Sample> sample(const Eigen::Vector3d& p_volume) const;

 private:
  static Sample interpolate(const double (&value)[8], const Eigen::Vector3d& share);
  VolumeOptions options_;
  std::vector<std::unique_ptr<VoxelBlock>> blocks_;
  std::vector<BlockKey> keys_;  // of blocks_, side by side
  std::uint32_t changes_ = 0;
  BlockIndex index_;
};

}  // namespace povslam
