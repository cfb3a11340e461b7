// Where the voxels of a block fall, a vector of them at a time. Only for *.kernel.cpp.
#pragma once

#include "pipeline/mapping/kernels/kernels.hpp"
#include "pipeline/mapping/kernels/lanes.hpp"

namespace povslam::POVSLAM_ISA {

enum { kEdge = 8, kVoxels = kEdge * kEdge * kEdge };

struct Rays {
  Floats depth_m;
  Ints column, row, pixel;  // nearest one, and its index
  Mask inside;              // before the camera and in the part
};

// Voxels whose depth is less than this are not projected.
constexpr float kNear_m = 0.02F;

POVSLAM_INLINE Floats coordinate(const BlockRays& rays, const float* origin, int voxel, int axis) {
  const float slice = origin[axis] + static_cast<float>(voxel / (kEdge * kEdge)) * rays.along[2][axis];
  const int y = voxel / kEdge % kEdge;
  const float first = slice + static_cast<float>(y) * rays.along[1][axis];
  const float second = slice + static_cast<float>(y + 1) * rays.along[1][axis];
  alignas(64) static const float kColumn[16] = {0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7};
  return fill_rows(first, second) + load(kColumn + voxel % kEdge) * fill(rays.along[0][axis]);
}

// Of `kLanes` voxels from `voxel` on.
POVSLAM_INLINE Rays project(const BlockRays& rays, const float* origin, int voxel) {
  Rays out;
  out.depth_m = coordinate(rays, origin, voxel, 2);
  const Mask before = above(out.depth_m, fill(kNear_m));
  const Floats inverse = fill(1.0F) / out.depth_m;
  // Clamped, so that what lies far outside has integers of its own side.
  const Floats low = fill(-1.0F), high = fill(65536.0F);
  out.column = round_to_int(lesser(greater(coordinate(rays, origin, voxel, 0) * inverse, low), high));
  out.row = round_to_int(lesser(greater(coordinate(rays, origin, voxel, 1) * inverse, low), high));
  const Mask left_top = both(above(out.column, fill_int(-1)), above(out.row, fill_int(-1)));
  const Mask right_bottom = both(above(fill_int(rays.columns), out.column), above(fill_int(rays.rows), out.row));
  out.inside = both(before, both(left_top, right_bottom));
  out.pixel = add(multiply(out.row, fill_int(rays.columns)), out.column);
  return out;
}

}  // namespace povslam::POVSLAM_ISA
