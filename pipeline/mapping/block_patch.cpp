#include "pipeline/mapping/block_patch.hpp"

#include <algorithm>
#include <cmath>

namespace povslam {

namespace {

// Which of three neighbours along an axis holds voxel -1 … 9, and as which of its own.
constexpr int neighbour(int voxel) {
  return voxel < 0 ? 0 : voxel < kBlockEdge ? 1 : 2;
}
constexpr std::size_t index_within(int x, int y, int z) {
  constexpr int kMask = kBlockEdge - 1;
  return static_cast<std::size_t>((x & kMask) + kBlockEdge * ((y & kMask) + kBlockEdge * (z & kMask)));
}

}  // namespace

bool BlockPatch::load(const Volume& volume, int block, double min_weight) {
  const BlockKey centre = volume.key(block);
  for (int k = 0; k < 27; ++k) {
    const BlockKey key{centre.x + k % 3 - 1, centre.y + k / 3 % 3 - 1, centre.z + k / 9 - 1};
    const int found = k == 13 ? block : volume.find(key);
    blocks_[static_cast<std::size_t>(k)] = found < 0 ? nullptr : &volume.block(found);
  }
  const int least = std::max(1, static_cast<int>(std::ceil(min_weight * kWeightUnits)));
  bool positive = false, negative = false;
  for (int z = -1; z < kEdge - 1; ++z) {
    for (int y = -1; y < kEdge - 1; ++y) {
      const int row = 3 * neighbour(y) + 9 * neighbour(z);
      for (int x = -1; x < kEdge - 1; ++x) {
        const VoxelBlock* from = blocks_[static_cast<std::size_t>(row + neighbour(x))];
        const std::size_t voxel = index_within(x, y, z), to = at(x, y, z);
        const bool is_known = from != nullptr && from->weight[voxel] >= least;
        known_[to] = is_known;
        distance_[to] = is_known ? from->distance[voxel] : std::int16_t{0};
        positive |= is_known && distance_[to] >= 0;
        negative |= is_known && distance_[to] < 0;
      }
    }
  }
  return positive && negative;
}

const std::uint8_t* BlockPatch::color(int x, int y, int z) const {
  const int from = neighbour(x) + 3 * neighbour(y) + 9 * neighbour(z);
  return &blocks_[static_cast<std::size_t>(from)]->color[3 * index_within(x, y, z)];
}

}  // namespace povslam
