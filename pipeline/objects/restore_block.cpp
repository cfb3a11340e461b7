#include "pipeline/objects/restore_block.hpp"

#include <algorithm>

namespace povslam {

void restore_block(const VoxelBlockRow& row, Volume& volume) {
  constexpr auto kVoxels = static_cast<std::size_t>(kBlockVoxels);
  if (row.distance.size() != kVoxels || row.weight.size() != kVoxels || row.color.size() != 3 * kVoxels) return;
  const int index = volume.allocate({row.x, row.y, row.z});
  if (index < 0) return;
  VoxelBlock& block = volume.block(index);
  std::ranges::copy(row.distance, block.distance.begin());
  std::ranges::copy(row.weight, block.weight.begin());
  std::ranges::copy(row.color, block.color.begin());
  volume.mark_changed(index);
}

}  // namespace povslam
