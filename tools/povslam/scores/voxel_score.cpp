#include "tools/povslam/scores/voxel_score.hpp"

#include <algorithm>
#include <cmath>

namespace povslam::scores {
namespace {

constexpr double kSamplesPerVoxel = 10.0;

struct Triangle {
  Eigen::Vector3d a, b, c;
  double steps(double voxel_size_m) const {
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    return std::max(1.0, std::ceil(longest / voxel_size_m * kSamplesPerVoxel));
  }
};

void add_samples(const Triangle& triangle, double voxel_size_m, VoxelSet& voxels) {
  const double steps = triangle.steps(voxel_size_m);
  const Eigen::Vector3d u = (triangle.b - triangle.a) / steps, v = (triangle.c - triangle.a) / steps;
  for (double i = 0.0; i <= steps; i += 1.0) {
    for (double j = 0.0; j <= steps - i; j += 1.0) {
      voxels.insert(voxel_at(triangle.a + i * u + j * v, voxel_size_m));
    }
  }
}

struct Box {
  Voxel low, high;
  bool contains(const Voxel& v) const {
    return v.x >= low.x && v.x <= high.x && v.y >= low.y && v.y <= high.y && v.z >= low.z && v.z <= high.z;
  }
  std::size_t cells() const {
    if (high.z < low.z) return 0;
    return static_cast<std::size_t>(high.x - low.x + 1) * static_cast<std::size_t>(high.y - low.y + 1) *
           static_cast<std::size_t>(high.z - low.z + 1);
  }
};

Box padded_bounds(const VoxelSet& voxels, std::int32_t first_layer) {
  Box box{*voxels.begin(), *voxels.begin()};
  for (const Voxel& v : voxels) {
    box.low = {std::min(box.low.x, v.x), std::min(box.low.y, v.y), std::min(box.low.z, v.z)};
    box.high = {std::max(box.high.x, v.x), std::max(box.high.y, v.y), std::max(box.high.z, v.z)};
  }
  box.low = {box.low.x - 1, box.low.y - 1, std::max(first_layer, box.low.z - 1)};
  box.high = {box.high.x + 1, box.high.y + 1, box.high.z + 1};
  return box;
}

}  // namespace

Voxel voxel_at(const Eigen::Vector3d& p_world, double voxel_size_m) {
  const auto index = [voxel_size_m](double x) { return static_cast<std::int32_t>(std::floor(x / voxel_size_m + 0.5)); };
  return {index(p_world.x()), index(p_world.y()), index(p_world.z())};
}

VoxelSet voxels_of_points(std::span<const Eigen::Vector3d> points_world, double voxel_size_m) {
  VoxelSet voxels;
  for (const Eigen::Vector3d& p_world : points_world) voxels.insert(voxel_at(p_world, voxel_size_m));
  return voxels;
}

Result<VoxelSet> voxels_of_mesh(const PlyMesh& mesh, double voxel_size_m) {
  if (mesh.triangles.empty()) return voxels_of_points(mesh.vertices, voxel_size_m);
  constexpr double kMostSamples = 3e8;
  double samples = 0.0;
  VoxelSet voxels;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Triangle triangle{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
    samples += 0.5 * std::pow(triangle.steps(voxel_size_m) + 1.0, 2.0);
    if (samples > kMostSamples) return Error{"too much surface for voxels of this size; are its coordinates metres?"};
    add_samples(triangle, voxel_size_m, voxels);
  }
  return voxels;
}

void drop_floor(VoxelSet& voxels, double floor_z_m, double voxel_size_m) {
  const std::int32_t floor_layer = voxel_at({0.0, 0.0, floor_z_m}, voxel_size_m).z;
  std::erase_if(voxels, [floor_layer](const Voxel& voxel) { return voxel.z <= floor_layer; });
}

VoxelCounts score_voxels(const VoxelSet& truth, const VoxelSet& map, const VoxelSet& excused,
                         std::int32_t first_layer) {
  VoxelCounts counts;
  const bool bounded = !truth.empty();
  const Box box = bounded ? padded_bounds(truth, first_layer) : Box{};
  std::size_t excused_in_box = 0;
  for (const Voxel& voxel : map) {
    const bool in_box = bounded && box.contains(voxel);
    if (truth.contains(voxel)) {
      ++counts.true_positive;
    } else if (excused.contains(voxel)) {
      ++counts.excused;
      if (in_box) ++excused_in_box;
    } else {
      ++counts.false_positive;
      if (in_box) ++counts.false_positive_in_box;
    }
  }
  counts.false_negative = truth.size() - counts.true_positive;
  if (bounded) counts.true_negative = box.cells() - truth.size() - counts.false_positive_in_box - excused_in_box;
  return counts;
}

}  // namespace povslam::scores
