#include "pipeline/mapping/integrate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
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
    BlockKey& recent = recent_[static_cast<std::size_t>((key.x & 15) | (key.y & 15) << 4 | (key.z & 15) << 8)];
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
  static constexpr int kRecent = 4096;
  Volume& volume_;
  IntegrateReport& report_;
  std::array<BlockKey, kRecent> recent_ = [] {
    std::array<BlockKey, kRecent> none{};
    none.fill({1 << 30, 1 << 30, 1 << 30});
    return none;
  }();
};

// The owner's pixels of one row of the image.
class RayRow {
 public:
  static constexpr int kHalf = 1 << (kKeyBits - 1);

  RayRow(const DepthView& view, std::uint16_t owner, int stride_px)
      : view_(view), owner_(owner), stride_px_(stride_px), size_((view.camera.width + stride_px - 1) / stride_px) {
    for (std::vector<float>* values : {&depth_m_, &column_}) values->resize(static_cast<std::size_t>(size_));
    for (std::vector<std::uint32_t>* values : {&keys_, &scratch_}) values->resize(static_cast<std::size_t>(size_) + 17);
  }

  bool read(int row) {  // whether there are any
    fetch(std::min(row + stride_px_, view_.camera.height - 1));
    const float* depth = view_.depth_m.row(row);
    const std::uint16_t* whose = view_.owner.row(row);
    std::size_t count = 0;
    for (int column = 0; column < view_.camera.width; column += stride_px_) {
      depth_m_[count] = depth[column];
      column_[count] = static_cast<float>(column);
      count += (whose[column] == owner_) & (depth[column] > 0.0F);
    }
    count_ = count;
    return count > 0;
  }

  std::span<const std::uint32_t> find_keys(const RayBlocks& rays, const MappingKernels& kernels) {
    const int different = kernels.find_keys(&rays, depth_m_.data(), column_.data(), static_cast<int>(count_),
                                            keys_.data(), scratch_.data());
    return {keys_.data(), static_cast<std::size_t>(different)};
  }

 private:
  // Starts to bring a row near: the processor does not expect it so far from the last one.
  void fetch(int row) const {
    const auto *depth = reinterpret_cast<const char*>(view_.depth_m.row(row)),
               *whose = reinterpret_cast<const char*>(view_.owner.row(row));
    const std::size_t columns = static_cast<std::size_t>(view_.camera.width);
    for (std::size_t k = 0; k < columns * sizeof(float); k += 64) __builtin_prefetch(depth + k);
    for (std::size_t k = 0; k < columns * sizeof(std::uint16_t); k += 64) __builtin_prefetch(whose + k);
  }

  const DepthView& view_;
  std::uint16_t owner_;
  int stride_px_, size_;
  std::size_t count_ = 0;
  std::vector<float> depth_m_, column_;
  std::vector<std::uint32_t> keys_, scratch_;
};

void allocate_about_surfaces(Volume& volume, const DepthView& view, std::uint16_t owner, const Rigid3& T_volume_camera,
                             int stride_px, const MappingKernels& kernels, IntegrateReport& report) {
  Allocator allocator(volume, report);
  const double per_block = 1.0 / (kBlockEdge * volume.options().voxel_size_m);
  const auto truncation_m = static_cast<float>(volume.options().truncation_m);
  // Half a block from sample to sample along the ray.
  const int steps = std::max(1, static_cast<int>(std::ceil(4.0 * volume.options().truncation_m * per_block)));
  const Eigen::Matrix3f rotation = (T_volume_camera.matrix3() * per_block).cast<float>();
  const Eigen::Vector3d camera = T_volume_camera.translation * per_block;
  const Eigen::Vector3d base = camera.array().floor() - RayRow::kHalf;
  const Eigen::Vector3f start = (camera - base).cast<float>();
  const BlockKey origin{static_cast<std::int32_t>(base.x()), static_cast<std::int32_t>(base.y()),
                        static_cast<std::int32_t>(base.z())};
  constexpr std::uint32_t kMask = (1U << kKeyBits) - 1;
  const PinholeCamera& c = view.camera;
  const Eigen::Vector3f along = rotation.col(0) / static_cast<float>(c.fx);
  const auto store = [](const Eigen::Vector3f& v, float* out) { std::copy_n(v.data(), 3, out); };
  RayBlocks blocks{};
  store(start, blocks.start);
  store(along, blocks.along);
  RayRow rays(view, owner, stride_px);
  for (int row = 0; row < c.height; row += stride_px) {
    if (!rays.read(row)) continue;
    const Eigen::Vector3f first = rotation.col(2) + rotation.col(1) * static_cast<float>((row - c.cy) / c.fy) -
                                  rotation.col(0) * static_cast<float>(c.cx / c.fx);
    store(first, blocks.first);
    for (int k = 0; k <= steps; ++k) {
      blocks.ahead_m = truncation_m * (2.0F * static_cast<float>(k) / static_cast<float>(steps) - 1.0F);
      for (const std::uint32_t key : rays.find_keys(blocks, kernels)) {
        allocator.ask({origin.x + static_cast<std::int32_t>(key & kMask),
                       origin.y + static_cast<std::int32_t>(key >> kKeyBits & kMask),
                       origin.z + static_cast<std::int32_t>(key >> 2 * kKeyBits & kMask)});
      }
    }
  }
}

// The view as this owner's volume sees it, for the pixels of `box`. The buffers are kept: memory fresh from the system
// for each call would cost as much as the work on it.
struct Look {
  std::vector<LookPixel> pixels;
  std::vector<std::uint16_t> farthest, scratch;
  PixelBox box;
  float unit_m = 0.0F;

  void make(const DepthView& view, std::uint16_t owner, const PixelBox& of, const MappingKernels& kernels) {
    box = of;
    const std::size_t wanted = static_cast<std::size_t>(box.columns()) * static_cast<std::size_t>(box.rows());
    if (pixels.size() <= wanted) pixels.resize(wanted + 1);
    pixels[wanted] = 0;
    const auto tiles = static_cast<std::size_t>(look_tiles(box.columns()) * look_tiles(box.rows()));
    if (farthest.size() < tiles) farthest.resize(tiles);
    const std::size_t row = static_cast<std::size_t>(kLookScratch * (box.columns() + 2 * kClearRadius));
    if (scratch.size() < row) scratch.resize(row);
    unit_m = static_cast<float>(view.max_depth_m) / kMostUnits;
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
                            owner,
                            unit_m};
    kernels.make_look(&source, pixels.data(), farthest.data(), scratch.data());
  }

  // Whether something was measured where the block lies, and not all of it before the block by more than `behind_m`.
  bool reaches(const BlockInView& block, float behind_m) const {
    const int columns = look_tiles(box.columns());
    const int left = (block.box.x0 - box.x0) / kLookTile, right = (block.box.x1 - 1 - box.x0) / kLookTile;
    std::uint16_t most = 0;
    for (int y = (block.box.y0 - box.y0) / kLookTile; y <= (block.box.y1 - 1 - box.y0) / kLookTile; ++y) {
      const std::uint16_t* tile = farthest.data() + y * columns;
      for (int x = left; x <= right; ++x) most = std::max(most, tile[x]);
    }
    return most > 0 && block.nearest_m <= (static_cast<float>(most) + 1.0F) * unit_m + behind_m;
  }
};

IntegratePass make_pass(const Volume& volume, const DepthView& view, const IntegrateOptions& options,
                        const BlockRays& rays, const Look& look) {
  const double units_per_m = kDistanceUnits / volume.options().truncation_m;
  const double voxel = volume.options().voxel_size_m * units_per_m;
  IntegratePass pass{};
  pass.rays = rays;
  pass.look = look.pixels.data();
  pass.look_unit = static_cast<float>(static_cast<double>(look.unit_m) * units_per_m);
  pass.color = view.color.empty() ? nullptr : &view.color.at(look.box.x0, look.box.y0);
  pass.color_last = view.color.size() < 4 ? nullptr : view.color.data() + view.color.size() - 4;
  pass.color_stride = static_cast<std::int64_t>(view.color.stride());
  pass.channels = view.color.channels();
  pass.margin = static_cast<float>(0.5 * voxel);
  const double quadratic = 2.0 * options.depth_sigma_quadratic_per_m / units_per_m;
  const double floor = 2.0 * options.depth_sigma_floor_m * units_per_m;
  pass.quadratic = static_cast<float>(quadratic * quadratic);
  pass.floor = static_cast<float>(floor * floor);
  pass.behind_per_unit = static_cast<float>(1.0 / std::max(kDistanceUnits - voxel, 0.25 * voxel));
  pass.max_weight_units = static_cast<float>(std::clamp(options.max_weight * kWeightUnits, 1.0, 65535.0));
  return pass;
}

// Starts to bring a block near while another one is worked on.
void fetch(const VoxelBlock& block, bool colored) {
  const auto lines = [](const auto& values) {
    const auto* bytes = reinterpret_cast<const char*>(values.data());
    for (std::size_t k = 0; k < sizeof(values); k += 64) __builtin_prefetch(bytes + k, 1);
  };
  lines(block.distance);
  lines(block.weight);
  if (colored) lines(block.color);
}

BlockPlace place_of(const VoxelProjection& projection, const BlockKey& key, const IntegrateOptions& options) {
  const Eigen::Vector3f origin = projection.origin(key);
  const double z_m = static_cast<double>(projection.centre_depth_m(key));
  const double quadratic_m = options.depth_sigma_quadratic_per_m * z_m * z_m, floor_m = options.depth_sigma_floor_m;
  const double looks = std::min(1.0, kGoodSigma_m * kGoodSigma_m / (quadratic_m * quadratic_m + floor_m * floor_m));
  return {{origin.x(), origin.y(), origin.z()}, static_cast<float>(looks * kWeightUnits)};
}

bool has_inside(const VoxelBlock& block) {  // behind some surface
  // The sign bit of what is known, in words of the voxels' own width: the loop becomes vectors.
  unsigned any = 0;
  for (std::size_t first = 0; first < kBlockVoxels; first += kBlockEdge) {
    std::uint16_t sign = 0;
    for (std::size_t k = first; k < first + kBlockEdge; ++k) {
      const auto known = static_cast<std::uint16_t>(block.weight[k] != 0 ? 0xFFFF : 0);
      sign = static_cast<std::uint16_t>(sign | (known & static_cast<std::uint16_t>(block.distance[k])));
    }
    any |= sign;
  }
  return (any & 0x8000U) != 0;
}

// Of the blocks whose last surface has gone, and their neighbours: those that no surface needs are given back.
int remove_emptied(Volume& volume, const std::vector<BlockKey>& emptied) {
  std::vector<int> asked;
  for (const BlockKey& key : emptied) {
    for (int k = 0; k < 27; ++k) {
      const int index = volume.find({key.x + k % 3 - 1, key.y + k / 3 % 3 - 1, key.z + k / 9 - 1});
      if (index >= 0 && !has_inside(volume.block(index))) asked.push_back(index);
    }
  }
  std::sort(asked.begin(), asked.end());
  asked.erase(std::unique(asked.begin(), asked.end()), asked.end());
  BlockPatch patch;
  std::vector<BlockKey> useless;
  for (const int index : asked) {
    if (!patch.load(volume, index, 0.0)) useless.push_back(volume.key(index));
  }
  for (const BlockKey& key : useless) volume.remove(key);
  return static_cast<int>(useless.size());
}

}  // namespace

IntegrateReport integrate(Volume& volume, const DepthView& view, std::uint16_t owner, const Rigid3& T_world_volume,
                          const IntegrateOptions& options) {
  EXPECTS(owner != kNobody && options.allocation_stride_px > 0);
  const MappingKernels& kernels = mapping_kernels();
  IntegrateReport report;
  const Rigid3 T_camera_volume = view.T_world_camera.inverse() * T_world_volume;
  allocate_about_surfaces(volume, view, owner, T_camera_volume.inverse(), options.allocation_stride_px, kernels,
                          report);
  thread_local std::vector<BlockInView> in_view;
  const PixelBox box = blocks_in_view(volume, view, T_camera_volume, in_view);
  if (in_view.empty()) return report;

  thread_local Look look;
  look.make(view, owner, box, kernels);
  const auto behind_m = static_cast<float>(volume.options().truncation_m);
  std::erase_if(in_view, [&](const BlockInView& block) { return !look.reaches(block, behind_m); });
  report.blocks_in_view = static_cast<int>(in_view.size());
  const VoxelProjection projection(volume, view.camera, box, T_camera_volume);
  const IntegratePass pass = make_pass(volume, view, options, projection.rays(), look);
  std::vector<BlockKey> emptied;
  for (std::size_t k = 0; k < in_view.size(); ++k) {
    const int index = in_view[k].index;
    if (k + 1 < in_view.size()) fetch(volume.block(in_view[k + 1].index), pass.color != nullptr);
    VoxelBlock& block = volume.block(index);
    const BlockPlace place = place_of(projection, block.key, options);
    const unsigned outcome =
        kernels.integrate_block(&pass, &place, block.distance.data(), block.weight.data(), block.color.data());
    if ((outcome & kBlockChanged) != 0) volume.mark_changed(index);
    if ((outcome & kBlockEmptied) != 0 && !has_inside(block)) emptied.push_back(block.key);
  }
  report.blocks_removed = remove_emptied(volume, emptied);
  return report;
}

}  // namespace povslam
