#include "pipeline/mapping/integrate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "pipeline/base/expects.hpp"
#include "pipeline/mapping/block_patch.hpp"
#include "pipeline/mapping/kernels/dispatch.hpp"
#include "pipeline/mapping/visible_blocks.hpp"

namespace povslam {

namespace {

// Makes the blocks about the surfaces. Neighbouring rays ask for the same blocks: what was asked for lately is not
// looked up again.
class Allocator {
 public:
  Allocator(Volume& volume, IntegrateReport& report) : volume_(volume), report_(report) {}

  void ask(const BlockKey& key) {
    BlockKey& recent = recent_[static_cast<std::size_t>((key.x & 7) | (key.y & 7) << 3 | (key.z & 7) << 6)];
    if (recent == key) return;
    recent = key;
    const int before = volume_.num_blocks();
    if (volume_.allocate(key) < 0) {
      ++report_.blocks_refused;
    } else {
      report_.blocks_made += volume_.num_blocks() - before;
    }
  }

 private:
  Volume& volume_;
  IntegrateReport& report_;
  std::array<BlockKey, 512> recent_ = [] {
    std::array<BlockKey, 512> none{};
    none.fill({1 << 30, 1 << 30, 1 << 30});
    return none;
  }();
};

void allocate_about_surfaces(Volume& volume, const DepthView& view, std::uint16_t owner, const Rigid3& T_volume_camera,
                             int stride_px, IntegrateReport& report) {
  Allocator allocator(volume, report);
  const auto per_block = static_cast<float>(1.0 / (kBlockEdge * volume.options().voxel_size_m));
  const auto truncation_m = static_cast<float>(volume.options().truncation_m);
  // Half a block from sample to sample along the ray.
  const int steps = std::max(1, static_cast<int>(std::ceil(4.0F * truncation_m * per_block)));
  const float step_m = 2.0F * truncation_m / static_cast<float>(steps);
  const Eigen::Matrix3f rotation = T_volume_camera.matrix3().cast<float>() * per_block;
  const Eigen::Vector3f start = T_volume_camera.translation.cast<float>() * per_block;
  const auto inverse_fx = static_cast<float>(1.0 / view.camera.fx),
             inverse_fy = static_cast<float>(1.0 / view.camera.fy);
  const auto cx = static_cast<float>(view.camera.cx), cy = static_cast<float>(view.camera.cy);
  for (int y = 0; y < view.camera.height; y += stride_px) {
    const Eigen::Vector3f row = rotation.col(2) + rotation.col(1) * ((static_cast<float>(y) - cy) * inverse_fy) -
                                rotation.col(0) * (cx * inverse_fx);
    const Eigen::Vector3f along = rotation.col(0) * inverse_fx;
    const float* depth = view.depth_m.row(y);
    const std::uint16_t* whose = view.owner.row(y);
    for (int x = 0; x < view.camera.width; x += stride_px) {
      if (whose[x] != owner || !(depth[x] > 0.0F)) continue;
      const Eigen::Vector3f ray = row + along * static_cast<float>(x);
      for (int k = 0; k <= steps; ++k) {
        const float z = std::max(depth[x] - truncation_m + static_cast<float>(k) * step_m, 0.0F);
        const Eigen::Vector3f at = (start + ray * z).array().floor();
        allocator.ask(
            {static_cast<std::int32_t>(at.x()), static_cast<std::int32_t>(at.y()), static_cast<std::int32_t>(at.z())});
      }
    }
  }
}

// The view as this owner's volume sees it, for the pixels of `box`.
struct Look {
  std::unique_ptr<float[]> surface_m, clear_m;

  Look(const DepthView& view, std::uint16_t owner, const PixelBox& box, const MappingKernels& kernels) {
    const std::size_t pixels = static_cast<std::size_t>(box.columns()) * static_cast<std::size_t>(box.rows());
    surface_m = std::make_unique_for_overwrite<float[]>(pixels);
    clear_m = std::make_unique_for_overwrite<float[]>(pixels);
    const auto scratch =
        std::make_unique_for_overwrite<float[]>(12 * static_cast<std::size_t>(box.columns() + 2 * kClearRadius));
    const LookSource source{view.depth_m.data(),
                            view.owner.data(),
                            view.camera.width,
                            view.camera.height,
                            view.camera.width,
                            box.x0,
                            box.y0,
                            box.columns(),
                            box.rows(),
                            kNobody,
                            owner};
    kernels.make_look(&source, surface_m.get(), clear_m.get(), scratch.get());
  }
};

IntegratePass make_pass(const Volume& volume, const DepthView& view, const IntegrateOptions& options,
                        const PixelBox& box, const BlockRays& rays, const Look& look) {
  const VolumeOptions& v = volume.options();
  const auto square = [](double a) { return static_cast<float>(a * a); };
  IntegratePass pass{};
  pass.rays = rays;
  pass.surface_m = look.surface_m.get();
  pass.clear_m = look.clear_m.get();
  pass.channels = view.color.channels();
  pass.color_stride = static_cast<std::int64_t>(view.color.stride());
  pass.color = view.color.empty() ? nullptr : &view.color.at(box.x0, box.y0);
  pass.truncation_m = static_cast<float>(v.truncation_m);
  pass.units_per_m = static_cast<float>(kDistanceUnits / v.truncation_m);
  pass.margin_m = static_cast<float>(0.5 * v.voxel_size_m);
  pass.behind_per_unit = static_cast<float>(
      v.truncation_m / std::max(v.truncation_m - v.voxel_size_m, 0.25 * v.voxel_size_m) / kDistanceUnits);
  pass.color_units = static_cast<float>(2.0 * v.voxel_size_m * kDistanceUnits / v.truncation_m);
  pass.good_sigma2 = square(kGoodSigma_m);
  pass.quadratic2 = square(options.depth_sigma_quadratic_per_m);
  pass.floor2 = square(options.depth_sigma_floor_m);
  pass.units_per_look = kWeightUnits;
  pass.max_weight_units = static_cast<float>(std::clamp(options.max_weight * kWeightUnits, 1.0, 65535.0));
  return pass;
}

bool has_inside(const VoxelBlock& block) {  // behind some surface
  bool any = false;
  for (std::size_t k = 0; k < kBlockVoxels; ++k) any |= (block.weight[k] != 0) & (block.distance[k] < 0);
  return any;
}

// Of the blocks whose last surface has gone, and their neighbours: those that no surface needs are given back.
int remove_emptied(Volume& volume, const std::vector<BlockKey>& emptied) {
  BlockPatch patch;
  std::vector<BlockKey> useless;
  for (const BlockKey& key : emptied) {
    for (int k = 0; k < 27; ++k) {
      const BlockKey near{key.x + k % 3 - 1, key.y + k / 3 % 3 - 1, key.z + k / 9 - 1};
      const int index = volume.find(near);
      if (index < 0 || has_inside(volume.block(index)) || patch.load(volume, index, 0.0)) continue;
      useless.push_back(near);
    }
  }
  const int before = volume.num_blocks();
  for (const BlockKey& key : useless) volume.remove(key);
  return before - volume.num_blocks();
}

}  // namespace

IntegrateReport integrate(Volume& volume, const DepthView& view, std::uint16_t owner, const Rigid3& T_world_volume,
                          const IntegrateOptions& options) {
  EXPECTS(owner != kNobody && options.allocation_stride_px > 0);
  IntegrateReport report;
  const Rigid3 T_camera_volume = view.T_world_camera.inverse() * T_world_volume;
  allocate_about_surfaces(volume, view, owner, T_camera_volume.inverse(), options.allocation_stride_px, report);
  const VisibleBlocks visible = visible_blocks(volume, view, T_camera_volume);
  report.blocks_in_view = static_cast<int>(visible.indices.size());
  if (visible.indices.empty()) return report;

  const MappingKernels& kernels = mapping_kernels();
  const VoxelProjection projection(volume, view.camera, visible.box, T_camera_volume);
  const Look look(view, owner, visible.box, kernels);
  const IntegratePass pass = make_pass(volume, view, options, visible.box, projection.rays(), look);
  std::vector<BlockKey> emptied;
  for (const int index : visible.indices) {
    VoxelBlock& block = volume.block(index);
    const Eigen::Vector3f origin = projection.origin(block.key);
    const unsigned outcome =
        kernels.integrate_block(&pass, origin.data(), block.distance.data(), block.weight.data(), block.color.data());
    if ((outcome & kBlockChanged) != 0) volume.mark_changed(index);
    if ((outcome & kBlockEmptied) != 0 && !has_inside(block)) emptied.push_back(block.key);
  }
  report.blocks_removed = remove_emptied(volume, emptied);
  return report;
}

}  // namespace povslam
