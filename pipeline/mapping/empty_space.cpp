#include "pipeline/mapping/empty_space.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/base/expects.hpp"
#include "pipeline/mapping/nearest_depth.hpp"

namespace povslam {

namespace {

constexpr int kBits = 21;  // of each block coordinate

struct Place {
  std::int32_t x, y, z;
};
std::uint64_t packed(const Place& block) {
  const auto part = [](std::int32_t value) { return static_cast<std::uint64_t>(value) & 0x1FFFFF; };
  return part(block.x) | part(block.y) << kBits | part(block.z) << 2 * kBits;
}
Place unpacked(std::uint64_t key) {
  const auto part = [key](int shift) {
    return static_cast<std::int32_t>(static_cast<std::int64_t>(key >> shift << (64 - kBits)) >> (64 - kBits));
  };
  return {part(0), part(kBits), part(2 * kBits)};
}

// The world's box that the view may look into.
struct Reach {
  Eigen::Vector3d low, high;
};
Reach reach_of(const DepthView& view, double far_m) {
  Reach reach{view.T_world_camera.translation, view.T_world_camera.translation};
  for (const double u : {-0.5, view.camera.width - 0.5}) {
    for (const double v : {-0.5, view.camera.height - 0.5}) {
      const Eigen::Vector3d corner = view.T_world_camera * (view.camera.unproject({u, v}) * far_m);
      reach.low = reach.low.cwiseMin(corner);
      reach.high = reach.high.cwiseMax(corner);
    }
  }
  return reach;
}

// A ball before the camera in the picture.
struct Footprint {
  float depth_m = 0.0F;
  int column = 0, row = 0;  // of its middle
  PixelBox box;
};
std::optional<Footprint> footprint(const PinholeCamera& camera, const Eigen::Vector3f& p_camera, float radius_m) {
  const float nearest_m = p_camera.z() - radius_m;
  if (nearest_m < 0.1F) return std::nullopt;
  const float x = p_camera.x() / p_camera.z(), y = p_camera.y() / p_camera.z();
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const float u = fx * x + static_cast<float>(camera.cx) + 0.5F, v = fy * y + static_cast<float>(camera.cy) + 0.5F;
  if (u < 0.0F || v < 0.0F || u >= static_cast<float>(camera.width) || v >= static_cast<float>(camera.height)) {
    return std::nullopt;
  }
  const float half_x = fx * radius_m / nearest_m * std::sqrt(1.0F + x * x);
  const float half_y = fy * radius_m / nearest_m * std::sqrt(1.0F + y * y);
  if (u < half_x || v < half_y || u + half_x >= static_cast<float>(camera.width) ||
      v + half_y >= static_cast<float>(camera.height)) {
    return std::nullopt;
  }
  return Footprint{p_camera.z(),
                   static_cast<int>(u),
                   static_cast<int>(v),
                   {static_cast<int>(u - half_x), static_cast<int>(v - half_y), static_cast<int>(u + half_x) + 1,
                    static_cast<int>(v + half_y) + 1}};
}

}  // namespace

EmptySpace::EmptySpace(const EmptySpaceOptions& options, const DepthNoise& noise) : options_(options), noise_(noise) {
  EXPECTS(options.cell_size_m > 0.0 && options.max_cells >= 0);
}

void EmptySpace::observe(const DepthView& view) {
  const NearestDepth nearest(view.depth_m);
  const float farthest_m = *std::max_element(view.depth_m.pixels().begin(), view.depth_m.pixels().end());
  const Reach reach = reach_of(view, static_cast<double>(farthest_m));
  const double edge_m = kEdge * options_.cell_size_m;
  const auto block_of = [edge_m](double p) { return static_cast<std::int32_t>(std::floor(p / edge_m)); };
  const Rigid3 T_camera_world = view.T_world_camera.inverse();
  const double radius_m = edge_m * 0.8660255;
  for (std::int32_t z = block_of(reach.low.z()); z <= block_of(reach.high.z()); ++z) {
    for (std::int32_t y = block_of(reach.low.y()); y <= block_of(reach.high.y()); ++y) {
      for (std::int32_t x = block_of(reach.low.x()); x <= block_of(reach.high.x()); ++x) {
        const Eigen::Vector3d centre = T_camera_world * ((Eigen::Vector3d(x, y, z).array() + 0.5).matrix() * edge_m);
        if (centre.z() < -radius_m || centre.z() > static_cast<double>(farthest_m)) continue;
        observe_block(view, nearest, packed({x, y, z}));
      }
    }
  }
  if (num_cells_ > options_.max_cells) forget_oldest();
}

void EmptySpace::observe_block(const DepthView& view, const NearestDepth& nearest, std::uint64_t key) {
  const Rigid3 T_camera_world = view.T_world_camera.inverse();
  const auto size_m = static_cast<float>(options_.cell_size_m);
  const float radius_m = size_m * 0.8660255F;
  const Eigen::Matrix3f rotation = T_camera_world.matrix3().cast<float>() * size_m;
  const Place place = unpacked(key);
  const Eigen::Vector3d corner = kEdge * options_.cell_size_m * Eigen::Vector3d(place.x, place.y, place.z);
  const Eigen::Vector3f first = (T_camera_world * corner).cast<float>();
  for (int k = 0; k < kEdge * kEdge * kEdge; ++k) {
    const Eigen::Vector3f middle(static_cast<float>(k % kEdge) + 0.5F, static_cast<float>(k / kEdge % kEdge) + 0.5F,
                                 static_cast<float>(k / kEdge / kEdge) + 0.5F);
    const auto seen_at = footprint(view.camera, first + rotation * middle, radius_m);
    // The pixel at its middle alone rules most cells out: those without depth, and those behind what is measured there.
    if (!seen_at || !(view.depth_m.at(seen_at->column, seen_at->row) > seen_at->depth_m + radius_m)) continue;
    const float behind_m = nearest.within(seen_at->box);
    const auto sigma_m = static_cast<float>(std::hypot(
        noise_.quadratic_per_m * static_cast<double>(behind_m) * static_cast<double>(behind_m), noise_.floor_m));
    if (behind_m - 3.0F * sigma_m <= seen_at->depth_m + radius_m) continue;
    see(key, static_cast<std::size_t>(k), {view.stamp, view.stamp, 1});
  }
}

void EmptySpace::see(std::uint64_t key, std::size_t cell, const Seen& seen) {
  Block& block = blocks_[key];
  Seen& mine = block.cells[cell];
  if (mine.times == 0) {
    mine = seen;
    ++block.used;
    ++num_cells_;
  } else {
    mine.first = std::min(mine.first, seen.first);
    mine.last = std::max(mine.last, seen.last);
    mine.times += seen.times;
  }
  block.last = std::max(block.last, mine.last);
}

// Whole blocks at once, a tenth more than needed, so that this is not done in each view.
void EmptySpace::forget_oldest() {
  struct Age {
    TimeNs last;
    std::uint64_t key;
    bool operator<(const Age& other) const { return last != other.last ? last < other.last : key < other.key; }
  };
  std::vector<Age> ages;
  ages.reserve(blocks_.size());
  for (const auto& [key, block] : blocks_) ages.push_back({block.last, key});
  std::sort(ages.begin(), ages.end());
  const int wanted = options_.max_cells - options_.max_cells / 10;
  for (const Age& oldest : ages) {
    if (num_cells_ <= wanted) return;
    const auto found = blocks_.find(oldest.key);
    num_cells_ -= found->second.used;
    blocks_.erase(found);
  }
}

std::optional<EmptySpace::Seen> EmptySpace::at(const Eigen::Vector3d& p_world) const {
  const Eigen::Array3d cell = (p_world / options_.cell_size_m).array().floor();
  const Eigen::Array3d block = (cell / kEdge).floor();
  const auto found = blocks_.find(packed({static_cast<std::int32_t>(block.x()), static_cast<std::int32_t>(block.y()),
                                          static_cast<std::int32_t>(block.z())}));
  if (found == blocks_.end()) return std::nullopt;
  const Eigen::Array3i within = (cell - kEdge * block).cast<int>();
  const Seen& seen =
      found->second.cells[static_cast<std::size_t>(within.x() + kEdge * (within.y() + kEdge * within.z()))];
  if (seen.times == 0) return std::nullopt;
  return seen;
}

std::vector<EmptySpace::Cell> EmptySpace::cells(TimeNs seen_since) const {
  std::vector<Cell> cells;
  for (const auto& [key, block] : blocks_) {
    if (block.last < seen_since) continue;
    const Place place = unpacked(key);
    for (int k = 0; k < kEdge * kEdge * kEdge; ++k) {
      const Seen& seen = block.cells[static_cast<std::size_t>(k)];
      if (seen.times == 0 || seen.last < seen_since) continue;
      cells.push_back({kEdge * place.x + k % kEdge, kEdge * place.y + k / kEdge % kEdge,
                       kEdge * place.z + k / kEdge / kEdge, seen});
    }
  }
  return cells;
}

void EmptySpace::restore(const Cell& cell) {
  if (cell.seen.times <= 0) return;
  const auto low = [](std::int32_t value) { return value >= 0 ? value / kEdge : (value + 1) / kEdge - 1; };
  const Place block{low(cell.x), low(cell.y), low(cell.z)};
  const int within = cell.x - kEdge * block.x + kEdge * (cell.y - kEdge * block.y + kEdge * (cell.z - kEdge * block.z));
  see(packed(block), static_cast<std::size_t>(within), cell.seen);
  if (num_cells_ > options_.max_cells) forget_oldest();
}

}  // namespace povslam
