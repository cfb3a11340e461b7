// Sum of |observed - stored| distances over the voxels of a block that both know.
#include "pipeline/mapping/kernels/rays.hpp"

namespace povslam::POVSLAM_ISA {

CompareSum compare_block(const ComparePass* pass, const float* origin, const int16_t* distance,
                         const uint16_t* weight) {
  const Floats zero = fill(0.0F), full = fill(kFullUnits);
  CompareSum sum{0, 0};
  for (int voxel = 0; voxel < kVoxels; voxel += kLanes) {
    const Rays rays = project(pass->rays, origin, voxel);
    const Mask known = both(rays.inside, above(load16(weight + voxel), zero));
    if (bits(known) == 0) continue;
    const Floats depth = gather(pass->depth_m, rays.pixel, known);
    const Floats ahead = depth * fill(pass->units_per_m) - rays.depth;
    const Floats observed = lesser(ahead, full), stored = load16(distance + voxel);
    const Mask near = above(full, magnitude(stored));
    const Mask counts = both(both(known, above(depth, zero)), both(near, at_least(ahead, zero - full)));
    alignas(64) int32_t difference[kLanes];
    store(difference, round_to_int(magnitude(observed - stored)));
    for (unsigned left = bits(counts); left != 0; left &= left - 1) {
      sum.difference_units += difference[__builtin_ctz(left)];
      ++sum.voxels;
    }
  }
  return sum;
}

}  // namespace povslam::POVSLAM_ISA
