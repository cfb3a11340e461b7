#include <cmath>
#include <cstdlib>

#include "pipeline/mapping/block_patch.hpp"
#include "pipeline/mapping/compare.hpp"

namespace povslam {

namespace {

// From voxel to voxel a distance changes by a voxel's size, more where the surface was looked at slantingly. What
// changes by more than this many voxel sizes is no surface: space that was never seen lies beside free space.
constexpr double kSteepest = 3.0;

class PointFinder {
 public:
  PointFinder(const BlockPatch& patch, const VolumeOptions& options)
      : patch_(patch),
        voxel_units_(options.voxel_size_m / options.truncation_m * kDistanceUnits),
        steepest_units_(static_cast<int>(kSteepest * voxel_units_)) {}

  // Mean of the crossings on the edges from a voxel to its next ones, in voxels; false: there is none.
  bool crossing(int x, int y, int z, Eigen::Vector3f& mean) const {
    const int here = patch_.distance(x, y, z);
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    int count = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int nx = x + (axis == 0), ny = y + (axis == 1), nz = z + (axis == 2);
      if (!patch_.known(nx, ny, nz)) continue;
      const int there = patch_.distance(nx, ny, nz);
      if ((here < 0) == (there < 0) || std::abs(here - there) > steepest_units_) continue;
      sum[axis] += static_cast<float>(here) / static_cast<float>(here - there);
      ++count;
    }
    if (count == 0) return false;
    mean = Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)) +
           sum / static_cast<float>(count);
    return true;
  }

  // Of the distance; out of the surface, not a unit vector.
  Eigen::Vector3f gradient(int x, int y, int z) const {
    Eigen::Vector3f slope = Eigen::Vector3f::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const int dx = axis == 0, dy = axis == 1, dz = axis == 2;
      const bool before = patch_.known(x - dx, y - dy, z - dz), behind = patch_.known(x + dx, y + dy, z + dz);
      const int low = before ? patch_.distance(x - dx, y - dy, z - dz) : patch_.distance(x, y, z);
      const int high = behind ? patch_.distance(x + dx, y + dy, z + dz) : patch_.distance(x, y, z);
      if (before || behind) slope[axis] = static_cast<float>(high - low) / static_cast<float>(before + behind);
    }
    return slope;
  }

 private:
  const BlockPatch& patch_;
  double voxel_units_;
  int steepest_units_;
};

}  // namespace

std::vector<SurfacePoint> surface_points(const Volume& volume, double min_weight) {
  std::vector<SurfacePoint> points;
  BlockPatch patch;
  const auto size_m = static_cast<float>(volume.options().voxel_size_m);
  for (int index = 0; index < volume.num_blocks(); ++index) {
    if (!patch.load(volume, index, min_weight)) continue;
    const PointFinder finder(patch, volume.options());
    const BlockKey key = volume.key(index);
    const Eigen::Vector3f first =
        Eigen::Vector3f(static_cast<float>(key.x), static_cast<float>(key.y), static_cast<float>(key.z)) *
            static_cast<float>(kBlockEdge) +
        Eigen::Vector3f::Constant(0.5F);
    for (int z = 0; z < kBlockEdge; ++z) {
      for (int y = 0; y < kBlockEdge; ++y) {
        for (int x = 0; x < kBlockEdge; ++x) {
          Eigen::Vector3f at;
          if (!patch.known(x, y, z) || !finder.crossing(x, y, z, at)) continue;
          const Eigen::Vector3f slope = finder.gradient(x, y, z);
          const float length = slope.norm();
          if (length > 0.0F) points.push_back({(first + at) * size_m, slope / length});
        }
      }
    }
  }
  return points;
}

}  // namespace povslam
