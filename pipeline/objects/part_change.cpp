#include "pipeline/objects/part_change.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace povslam {
namespace {

constexpr int kMissedViews = 3;
constexpr std::size_t kFewest = 30;  // points of the part, and of the rest that this view sees
constexpr double kCleanShare = 0.1;  // of the part's points, those of the rest seen standing in its box

// Points that hang together on a grid of two voxels, 26 neighbours each; the largest set, as indices.
std::vector<std::size_t> largest_cluster(const MapObject& object) {
  using Cell = std::array<int, 3>;
  const double cell_m = 2.0 * object.volume.options().voxel_size_m;
  std::map<Cell, std::vector<std::size_t>> cells;
  for (std::size_t i = 0; i < object.surface.size(); ++i) {
    if (object.missed[i] < kMissedViews) continue;
    const Eigen::Vector3d at = (object.surface[i].p_volume.cast<double>() / cell_m).array().floor();
    cells[{static_cast<int>(at.x()), static_cast<int>(at.y()), static_cast<int>(at.z())}].push_back(i);
  }
  std::vector<std::size_t> largest;
  while (!cells.empty()) {
    std::vector<std::size_t> cluster;
    std::vector<Cell> open{cells.begin()->first};
    while (!open.empty()) {
      const Cell cell = open.back();
      open.pop_back();
      const auto found = cells.find(cell);
      if (found == cells.end()) continue;
      cluster.insert(cluster.end(), found->second.begin(), found->second.end());
      cells.erase(found);
      for (int k = 0; k < 27; ++k) {
        open.push_back({cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1});
      }
    }
    if (cluster.size() > largest.size()) largest = std::move(cluster);
  }
  return largest;
}

float nearest_m2(const Eigen::Vector3f& p, std::span<const SurfacePoint> among) {
  float least = 1e9F;
  for (const SurfacePoint& point : among) least = std::min(least, (point.p_volume - p).squaredNorm());
  return least;
}

bool large(const Box& box, double min_m) {
  std::array<double, 3> sides{box.size_m.x(), box.size_m.y(), box.size_m.z()};
  std::sort(sides.begin(), sides.end());
  return sides[1] >= min_m;
}

}  // namespace

void count_missed(MapObject& object, std::span<const PointLook> looks) {
  EXPECTS(looks.size() == object.missed.size());
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (looks[i] == PointLook::agrees) object.missed[i] = 0;
    if (looks[i] == PointLook::seen_through && object.missed[i] < 255) ++object.missed[i];
  }
}

std::optional<MissingPart> find_missing_part(const MapObject& object, std::span<const PointLook> looks, double min_m,
                                             double deepest_m) {
  std::vector<SurfacePoint> seen_through, standing;
  for (const std::size_t i : largest_cluster(object)) seen_through.push_back(object.surface[i]);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (looks[i] == PointLook::agrees) standing.push_back(object.surface[i]);
  }
  if (std::min(seen_through.size(), standing.size()) < kFewest) return std::nullopt;
  const double voxel_m = object.volume.options().voxel_size_m;
  const auto box = box_of_surface(seen_through, voxel_m, deepest_m);
  if (!box || !large(*box, min_m)) return std::nullopt;
  const auto among = std::ranges::count_if(
      standing, [&](const SurfacePoint& point) { return box->contains(point.p_volume.cast<double>()); });
  if (static_cast<double>(among) > kCleanShare * static_cast<double>(seen_through.size())) return std::nullopt;

  // What this view does not show, backs and sides, goes with whichever is nearer.
  MissingPart part;
  for (const SurfacePoint& point : object.surface) {
    const bool gone = nearest_m2(point.p_volume, seen_through) < nearest_m2(point.p_volume, standing);
    (gone ? part.surface : part.rest).push_back(point);
  }
  const auto part_box = box_of_surface(part.surface, voxel_m, deepest_m);
  const auto rest_box = box_of_surface(part.rest, voxel_m, deepest_m);
  if (!part_box || !rest_box || !large(*rest_box, min_m)) return std::nullopt;
  part.box = *part_box;
  part.rest_box = *rest_box;
  return part;
}

Volume cut_out(MapObject& object, const MissingPart& part) {
  return cut_out(object.volume, [&](const Eigen::Vector3f& p_volume) {
    return nearest_m2(p_volume, part.surface) < nearest_m2(p_volume, part.rest);
  });
}

Volume cut_out(Volume& volume, const std::function<bool(const Eigen::Vector3f& p_volume)>& goes) {
  const double voxel_m = volume.options().voxel_size_m;
  Volume taken(volume.options());
  for (int i = 0; i < volume.num_blocks(); ++i) {
    VoxelBlock& block = volume.block(i);
    const Eigen::Vector3d corner = Eigen::Vector3d(block.key.x, block.key.y, block.key.z) * (kBlockEdge * voxel_m);
    VoxelBlock* copy = nullptr;
    for (int v = 0; v < kBlockVoxels; ++v) {
      const auto k = static_cast<std::size_t>(v);
      if (block.weight[k] == 0) continue;
      const Eigen::Vector3d cell(v % kBlockEdge + 0.5, v / kBlockEdge % kBlockEdge + 0.5,
                                 v / (kBlockEdge * kBlockEdge) + 0.5);
      if (!goes((corner + cell * voxel_m).cast<float>())) continue;
      if (copy == nullptr) copy = &taken.block(taken.allocate(block.key));
      copy->distance[k] = block.distance[k];
      copy->weight[k] = block.weight[k];
      std::copy_n(block.color.begin() + 3 * v, 3, copy->color.begin() + 3 * v);
      block.weight[k] = 0;
    }
    if (copy != nullptr) volume.mark_changed(i);
  }
  return taken;
}

}  // namespace povslam
