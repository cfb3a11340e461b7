// Where the voxels of a block fall, a vector of them at a time. Only for *.kernel.cpp.
#pragma once

#include "pipeline/mapping/kernels/kernels.hpp"
#include "pipeline/mapping/kernels/lanes.hpp"

namespace povslam::POVSLAM_ISA {

enum { kEdge = 8, kVoxels = kEdge * kEdge * kEdge };

struct Rays {
  Floats depth;             // distance units
  Ints column, row, pixel;  // nearest one, and its index
  Mask inside;              // before the camera and in the part
};

POVSLAM_INLINE Floats coordinate(const BlockRays& rays, const float* origin, int voxel, int axis) {
  const float slice = origin[axis] + static_cast<float>(voxel / (kEdge * kEdge)) * rays.next_slice[axis];
  return fill(slice) + load(rays.in_slice[axis] + voxel % (kEdge * kEdge));
}

// Of `kLanes` voxels from `voxel` on. What lies too far off for an integer becomes the least one.
POVSLAM_INLINE Rays project(const BlockRays& rays, const float* origin, int voxel) {
  Rays out;
  out.depth = coordinate(rays, origin, voxel, 2);
  const Floats inverse = fill(1.0F) / out.depth;
  out.column = round_to_int(coordinate(rays, origin, voxel, 0) * inverse);
  out.row = round_to_int(coordinate(rays, origin, voxel, 1) * inverse);
  out.inside =
      both(above(out.depth, fill(rays.near)), both(within(out.column, rays.columns), within(out.row, rays.rows)));
  out.pixel = add(multiply(out.row, fill_int(rays.columns)), out.column);
  return out;
}

}  // namespace povslam::POVSLAM_ISA
