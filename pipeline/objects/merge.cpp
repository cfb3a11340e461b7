#include "pipeline/objects/merge.hpp"

#include <algorithm>
#include <cmath>

namespace povslam {
namespace {

// Blocks of `to` that hold or adjoin the surface of `from`.
void allocate_along(Volume& to, const MapObject& from, const Rigid3& T_to_from) {
  const double reach_m = to.options().truncation_m;
  for (const SurfacePoint& point : from.surface) {
    const Eigen::Vector3d p = T_to_from * point.p_volume.cast<double>();
    for (const double x : {-reach_m, reach_m}) {
      for (const double y : {-reach_m, reach_m}) {
        for (const double z : {-reach_m, reach_m}) to.allocate(to.key_of(p + Eigen::Vector3d(x, y, z)));
      }
    }
  }
}

void average(VoxelBlock& block, std::size_t voxel, const Volume::Sample& sample, double truncation_m) {
  const double units = kDistanceUnits / truncation_m;
  const double own = block.weight[voxel], other = sample.weight * kWeightUnits, sum = own + other;
  const double distance = (own * block.distance[voxel] + other * sample.distance_m * units) / sum;
  block.distance[voxel] =
      static_cast<std::int16_t>(std::lround(std::clamp<double>(distance, -kDistanceUnits, kDistanceUnits)));
  block.weight[voxel] = static_cast<std::uint16_t>(std::min(sum, 65535.0));
}

}  // namespace

void merge_into(MapObject& a, const MapObject& b) {
  const Rigid3 T_a_b = a.T_world_volume.inverse() * b.T_world_volume, T_b_a = T_a_b.inverse();
  allocate_along(a.volume, b, T_a_b);
  const double voxel_m = a.volume.options().voxel_size_m;
  for (int i = 0; i < a.volume.num_blocks(); ++i) {
    VoxelBlock& block = a.volume.block(i);
    const Eigen::Vector3d corner = Eigen::Vector3d(block.key.x, block.key.y, block.key.z) * (kBlockEdge * voxel_m);
    for (std::size_t v = 0; v < static_cast<std::size_t>(kBlockVoxels); ++v) {
      const Eigen::Vector3d cell(static_cast<double>(v % 8) + 0.5, static_cast<double>(v / 8 % 8) + 0.5,
                                 static_cast<double>(v / 64) + 0.5);
      const auto sample = b.volume.sample(T_b_a * (corner + cell * voxel_m));
      if (sample && sample->weight > 0.0) average(block, v, *sample, a.volume.options().truncation_m);
    }
    ++block.changed;
  }
  for (const auto& [id, votes] : b.class_votes) a.class_votes[id] += votes;
  a.first_seen = std::min(a.first_seen, b.first_seen);
  a.last_seen = std::max(a.last_seen, b.last_seen);
  a.observations += b.observations;
  a.looks += b.looks;
}

}  // namespace povslam
