// A block with one layer of voxels around it, two above it, wherever those are stored.
#pragma once

#include <array>

#include "pipeline/mapping/volume.hpp"

namespace povslam {

class BlockPatch {
 public:
  static constexpr int kEdge = kBlockEdge + 3;

  // Voxels seen less than min_weight looks are unknown. False, and nothing else is valid, if no zero crossing can lie
  // in the block or between it and the layer around.
  bool load(const Volume& volume, int block, double min_weight);

  // x, y, z: -1 … 9, of the block's own voxels.
  bool known(int x, int y, int z) const { return known_[at(x, y, z)]; }
  int distance(int x, int y, int z) const { return distance_[at(x, y, z)]; }  // 1 / kDistanceUnits of the truncation
  const std::uint8_t* color(int x, int y, int z) const;                       // R, G, B

 private:
  static std::size_t at(int x, int y, int z) {
    return static_cast<std::size_t>(x + 1 + kEdge * (y + 1 + kEdge * (z + 1)));
  }
  std::array<std::int16_t, kEdge * kEdge * kEdge> distance_{};
  std::array<bool, kEdge * kEdge * kEdge> known_{};
  std::array<const VoxelBlock*, 27> blocks_{};
};

}  // namespace povslam
