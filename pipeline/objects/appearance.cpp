#include "pipeline/objects/appearance.hpp"

#include <algorithm>
#include <cstdlib>

namespace povslam {

Appearance appearance_of(const Volume& volume) {
  Appearance out;
  const VolumeOptions& options = volume.options();
  const int near = static_cast<int>(options.voxel_size_m / options.truncation_m * kDistanceUnits);
  float sum = 0.0F;
  for (int i = 0; i < volume.num_blocks(); ++i) {
    const VoxelBlock& block = volume.block(i);
    for (std::size_t v = 0; v < static_cast<std::size_t>(kBlockVoxels); ++v) {
      if (block.weight[v] == 0 || std::abs(block.distance[v]) > near) continue;
      std::size_t bin = 0;
      for (std::size_t c = 0; c < 3; ++c)
        bin = bin * Appearance::kLevels + block.color[3 * v + c] * Appearance::kLevels / 256U;
      out.share[bin] += 1.0F;
      sum += 1.0F;
    }
  }
  if (sum > 0.0F) {
    for (float& share : out.share) share /= sum;
  }
  return out;
}

bool is_known(const Appearance& appearance) {
  return std::ranges::any_of(appearance.share, [](float share) { return share > 0.0F; });
}

double likeness(const Appearance& a, const Appearance& b) {
  float common = 0.0F;
  for (std::size_t i = 0; i < a.share.size(); ++i) common += std::min(a.share[i], b.share[i]);
  return static_cast<double>(common);
}

}  // namespace povslam
