#include "pipeline/mapping/volume.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/base/expects.hpp"

namespace povslam {

Volume::Volume(const VolumeOptions& options) : options_(options) {
  EXPECTS(options.voxel_size_m >= 0.002 && options.truncation_m >= options.voxel_size_m && options.max_blocks >= 0);
}

int Volume::find(const BlockKey& key) const {
  return index_.find(key);
}

int Volume::allocate(const BlockKey& key) {
  const int found = find(key);
  if (found >= 0) return found;
  if (num_blocks() >= options_.max_blocks) return -1;
  const int index = num_blocks();
  blocks_.push_back(std::make_unique<VoxelBlock>());
  keys_.push_back(key);
  index_.set(key, index);
  block(index).key = key;
  mark_changed(index);
  return index;
}

void Volume::remove(const BlockKey& key) {
  const int index = find(key);
  if (index < 0) return;
  const int last = num_blocks() - 1;
  if (index != last) {
    const auto hole = static_cast<std::size_t>(index);
    blocks_[hole] = std::move(blocks_.back());
    keys_[hole] = keys_.back();
    index_.set(keys_[hole], index);
  }
  blocks_.pop_back();
  keys_.pop_back();
  index_.remove(key);
}

void Volume::clear() {
  blocks_.clear();
  keys_.clear();
  index_.clear();
}

BlockKey Volume::key_of(const Eigen::Vector3d& p_volume) const {
  const double edge_m = kBlockEdge * options_.voxel_size_m;
  const auto part = [edge_m](double p) { return static_cast<std::int32_t>(std::floor(p / edge_m)); };
  return {part(p_volume.x()), part(p_volume.y()), part(p_volume.z())};
}

std::optional<Volume::Sample> Volume::sample(const Eigen::Vector3d& p_volume) const {
  const Eigen::Vector3d at = p_volume / options_.voxel_size_m - Eigen::Vector3d::Constant(0.5);
  const Eigen::Vector3d low = at.array().floor();
  const Eigen::Vector3i first = low.cast<int>();
  double value[8];  // of corner x + 2 y + 4 z
  int least = std::numeric_limits<int>::max(), index = -1;
  BlockKey key{};
  for (int corner = 0; corner < 8; ++corner) {
    const int x = first.x() + (corner & 1), y = first.y() + (corner >> 1 & 1), z = first.z() + (corner >> 2);
    const BlockKey wanted{x >> 3, y >> 3, z >> 3};
    if (corner == 0 || !(wanted == key)) index = find(wanted);
    key = wanted;
    if (index < 0) return std::nullopt;
    const auto voxel = static_cast<std::size_t>((x & 7) + kBlockEdge * ((y & 7) + kBlockEdge * (z & 7)));
    const VoxelBlock& here = block(index);
    if (here.weight[voxel] == 0) return std::nullopt;
    least = std::min<int>(least, here.weight[voxel]);
    value[corner] = here.distance[voxel] * options_.truncation_m / kDistanceUnits;
  }
  Sample sample = interpolate(value, at - low);
  sample.gradient /= options_.voxel_size_m;
  sample.weight = static_cast<double>(least) / kWeightUnits;
  return sample;
}

// Linear along each axis; the gradient is per voxel.
Volume::Sample Volume::interpolate(const double (&value)[8], const Eigen::Vector3d& share) {
  Sample sample;
  for (int corner = 0; corner < 8; ++corner) {
    Eigen::Vector3d weight, slope;
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = (corner >> axis & 1) != 0;
      weight[axis] = upper ? share[axis] : 1.0 - share[axis];
      slope[axis] = upper ? 1.0 : -1.0;
    }
    sample.distance_m += weight.prod() * value[corner];
    sample.gradient +=
        value[corner] * Eigen::Vector3d(slope.x() * weight.y() * weight.z(), weight.x() * slope.y() * weight.z(),
                                        weight.x() * weight.y() * slope.z());
  }
  return sample;
}

}  // namespace povslam
