#include "pipeline/structure_anchors.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace povslam {
namespace {

struct Piece {
  VoxelBlock block;  // as it was
  Rigid3 T_new_old;
  std::int64_t keyframe = -1;
};

Eigen::Vector3d corner_of(const BlockKey& key) {  // in voxels
  return Eigen::Vector3d(key.x, key.y, key.z) * kBlockEdge;
}

void average(VoxelBlock& to, std::size_t i, const VoxelBlock& from, std::size_t j) {
  const int own = to.weight[i], other = from.weight[j], sum = own + other;
  if (other == 0) return;
  const auto mean = [&](int a, int b) { return (own * a + other * b) / sum; };
  to.distance[i] = static_cast<std::int16_t>(mean(to.distance[i], from.distance[j]));
  for (std::size_t c = 0; c < 3; ++c) {
    to.color[3 * i + c] = static_cast<std::uint8_t>(mean(to.color[3 * i + c], from.color[3 * j + c]));
  }
  to.weight[i] = static_cast<std::uint16_t>(std::min(sum, 65535));
}

// Into the block of this key, which is made only if something of the piece falls into it. True: something did.
bool bring_into(Volume& volume, const BlockKey& key, const Piece& piece, const Rigid3& T_old_new) {
  const double voxel_m = volume.options().voxel_size_m;
  const Eigen::Matrix3d turn = T_old_new.matrix3();
  // Of the middle of the block's first voxel in the piece, in voxels.
  const Eigen::Vector3d first = turn * (corner_of(key) + Eigen::Vector3d::Constant(0.5)) +
                                T_old_new.translation / voxel_m - corner_of(piece.block.key);
  VoxelBlock* to = nullptr;
  int index = -1;
  for (int v = 0; v < kBlockVoxels; ++v) {
    const int x = v % kBlockEdge, y = v / kBlockEdge % kBlockEdge, z = v / (kBlockEdge * kBlockEdge);
    const Eigen::Vector3d at = first + x * turn.col(0) + y * turn.col(1) + z * turn.col(2);
    if (at.minCoeff() < 0.0 || at.maxCoeff() >= kBlockEdge) continue;
    const Eigen::Vector3i i = at.cast<int>();
    const auto from = static_cast<std::size_t>(i.x() + kBlockEdge * (i.y() + kBlockEdge * i.z()));
    if (piece.block.weight[from] == 0) continue;
    if (to == nullptr) {
      index = volume.allocate(key);
      if (index < 0) return false;  // full
      to = &volume.block(index);
    }
    average(*to, static_cast<std::size_t>(v), piece.block, from);
  }
  if (to != nullptr) volume.mark_changed(index);
  return to != nullptr;
}

// Keys of the blocks that the piece may now reach into, first and last.
std::pair<BlockKey, BlockKey> reach_of(const Piece& piece, const Volume& volume) {
  const double voxel_m = volume.options().voxel_size_m;
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e12), high = -low;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d cell(corner & 1, corner >> 1 & 1, corner >> 2);
    const Eigen::Vector3d p = piece.T_new_old * ((corner_of(piece.block.key) + kBlockEdge * cell) * voxel_m);
    low = low.cwiseMin(p), high = high.cwiseMax(p);
  }
  return {volume.key_of(low), volume.key_of(high)};
}

}  // namespace

void StructureAnchors::note(const Volume& volume, std::int64_t keyframe) {
  std::uint32_t newest = newest_change_;
  for (int i = 0; i < volume.num_blocks(); ++i) {
    const VoxelBlock& block = volume.block(i);
    if (block.changed <= newest_change_) continue;
    keyframe_of_[{block.key.x, block.key.y, block.key.z}] = keyframe;
    newest = std::max(newest, block.changed);
  }
  newest_change_ = newest;
}

int StructureAnchors::carry(Volume& volume, std::span<const KeyframeMotion> motions) {
  const double voxel_m = volume.options().voxel_size_m;
  std::vector<Piece> pieces;
  for (int i = 0; i < volume.num_blocks(); ++i) {
    const BlockKey& key = volume.block(i).key;
    const auto anchor = keyframe_of_.find({key.x, key.y, key.z});
    const Rigid3* T_new_old = anchor == keyframe_of_.end() ? nullptr : motion_of(motions, anchor->second);
    if (T_new_old == nullptr) continue;
    const Eigen::Vector3d middle = (corner_of(key) + Eigen::Vector3d::Constant(0.5 * kBlockEdge)) * voxel_m;
    if ((*T_new_old * middle - middle).norm() > voxel_m) {
      pieces.push_back({volume.block(i), *T_new_old, anchor->second});
    }
  }
  for (const Piece& piece : pieces) volume.remove(piece.block.key);
  std::map<Place, std::int64_t> kept;
  for (int i = 0; i < volume.num_blocks(); ++i) {
    const BlockKey& key = volume.block(i).key;
    if (const auto anchor = keyframe_of_.find({key.x, key.y, key.z}); anchor != keyframe_of_.end())
      kept.insert(*anchor);
  }
  for (const Piece& piece : pieces) {
    const auto [first, last] = reach_of(piece, volume);
    const Rigid3 T_old_new = piece.T_new_old.inverse();
    for (std::int32_t z = first.z; z <= last.z; ++z) {
      for (std::int32_t y = first.y; y <= last.y; ++y) {
        for (std::int32_t x = first.x; x <= last.x; ++x) {
          if (bring_into(volume, {x, y, z}, piece, T_old_new)) kept[{x, y, z}] = piece.keyframe;
        }
      }
    }
  }
  keyframe_of_ = std::move(kept);
  for (int i = 0; i < volume.num_blocks(); ++i) newest_change_ = std::max(newest_change_, volume.block(i).changed);
  return static_cast<int>(pieces.size());
}

}  // namespace povslam
