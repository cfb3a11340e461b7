#include "pipeline/objects/loose_surface.hpp"

#include <algorithm>
#include <cmath>

namespace povslam {
namespace {

constexpr std::uint16_t kLoose = 65535;

// Depth that is a mean of two surfaces lies between its neighbours, and they are far apart.
bool is_mixed(const ImageF& depth_m, int x, int y) {
  constexpr int kReach_px = 2;
  constexpr float kStep_m = 0.06F, kStepShare = 0.03F;
  if (x < kReach_px || y < kReach_px || x >= depth_m.width() - kReach_px || y >= depth_m.height() - kReach_px) {
    return true;
  }
  const float limit = kStep_m + kStepShare * depth_m.at(x, y);
  const auto apart = [&](int dx, int dy) {
    const float a = depth_m.at(x - dx, y - dy), b = depth_m.at(x + dx, y + dy);
    return !(a > 0.0F && b > 0.0F && std::abs(a - b) < limit);
  };
  return apart(kReach_px, 0) || apart(0, kReach_px);
}

}  // namespace

void LooseSurface::observe(DepthView& view, const ObjectLibrary& library) {
  for (const auto& object : library.objects()) {
    if (object->phase == ObjectPhase::confirmed && object->last_seen == view.stamp) forget_known(*object);
  }
  const std::vector<std::uint16_t> owned = library.mapped_owners();
  for (int y = 0; y < view.camera.height; ++y) {
    for (int x = 0; x < view.camera.width; ++x) {
      std::uint16_t& owner = view.owner.at(x, y);
      if (!(view.depth_m.at(x, y) > 0.0F) || owner == kStructure || owner == kMoving) continue;
      if (std::ranges::binary_search(owned, owner)) continue;
      owner = is_mixed(view.depth_m, x, y) ? kNobody : kLoose;
    }
  }
  integrate(volume_, view, kLoose, Rigid3{}, integrate_options_);
}

void LooseSurface::forget_known(const MapObject& object) {
  constexpr double kGrow_m = 0.1;
  const Box box_world = object.box_world();
  const Rigid3 T_volume_world = object.T_world_volume.inverse();
  const double voxel_m = volume_.options().voxel_size_m, block_m = kBlockEdge * voxel_m;
  const double reach_m = 0.5 * box_world.size_m.norm() + kGrow_m + block_m;
  for (int i = 0; i < volume_.num_blocks(); ++i) {
    const BlockKey key = volume_.key(i);
    const Eigen::Vector3d corner = Eigen::Vector3d(key.x, key.y, key.z) * block_m;
    if ((corner.array() + 0.5 * block_m - box_world.center.array()).matrix().norm() > reach_m) continue;
    VoxelBlock& block = volume_.block(i);
    bool forgot = false;
    for (std::size_t v = 0; v < static_cast<std::size_t>(kBlockVoxels); ++v) {
      if (block.weight[v] == 0) continue;
      const Eigen::Vector3d cell(static_cast<double>(v % 8) + 0.5, static_cast<double>(v / 8 % 8) + 0.5,
                                 static_cast<double>(v / 64) + 0.5);
      const Eigen::Vector3d p_world = corner + cell * voxel_m;
      if (!box_world.contains(p_world, kGrow_m) || !object.volume.sample(T_volume_world * p_world)) continue;
      block.weight[v] = 0;
      forgot = true;
    }
    if (forgot) volume_.mark_changed(i);
  }
}

void LooseSurface::append_to(Mesh& mesh, const MeshOptions& options) {
  MeshCache cache(options);
  cache.update(volume_);
  cache.append_to(mesh, Rigid3{});
}

}  // namespace povslam
