// The dense map's vector kernels: plain functions on raw pointers, compiled once per instruction set (*.kernel.cpp) and
// picked at run time (dispatch.hpp). Every set returns the same bits. Kernel sources include nothing but this,
// lanes.hpp and the intrinsics: an inline library function compiled for a wider set could be merged by the linker into
// code that runs on a narrower machine.
#pragma once

#include <stdint.h>

namespace povslam {

// Pixels around one within which the nearest depth says how far space is free.
enum { kClearRadius = 2 };

// A part of one view. Rows of what is read lie `stride` pixels apart, from pixel (0, 0) of the image.
struct LookSource {
  const float* depth_m;
  const uint16_t* owner;
  int width, height, stride;  // px, of the whole image
  int x0, y0, columns, rows;  // px, the part wanted, inside the image
  uint16_t nobody, mine;      // values of owner
};

// Where a block's voxels fall: voxel (x, y, z) of it has p = origin + x along[0] + y along[1] + z along[2], and lies at
// depth p[2] [m] in pixel (p[0], p[1]) / p[2] of the part.
struct BlockRays {
  float along[3][3];
  int columns, rows;  // px, of the part
};

struct IntegratePass {  // the same for all blocks of a call
  BlockRays rays;
  const float* surface_m;  // see make_look
  const float* clear_m;
  const uint8_t* color;  // of the part's first pixel; null: none
  int64_t color_stride;  // bytes
  int channels;          // 1 or 3
  float truncation_m;
  float units_per_m;      // of stored distance
  float margin_m;         // with 2 sigma: how far beyond a surface is clearly beyond
  float behind_per_unit;  // slope of the weight behind a surface: 0 at the truncation, full at the margin
  float color_units;      // voxels this near to the surface take its colour
  float good_sigma2, quadratic2, floor2;  // [m^2, 1/m^2, m^2] weight of a look: good / (quadratic z^4 + floor)
  float units_per_look, max_weight_units;
};

// Of a block: some distance is another, or known now; some voxel behind a surface was seen empty.
enum { kBlockChanged = 1, kBlockEmptied = 2 };

struct ComparePass {
  BlockRays rays;
  const float* depth_m;  // rows lie rays.columns apart
  float truncation_m, units_per_m;
};
struct CompareSum {
  int64_t voxels, difference_units;
};

struct MappingKernels {
  // Two images of columns x rows. surface_m: depth where the pixel is mine, else 0. clear_m: the least depth measured
  // within kClearRadius, 0 where there is none; negative where somebody else's surface alone is there.
  // scratch: 12 * (columns + 2 * kClearRadius) floats.
  void (*make_look)(const LookSource* source, float* surface_m, float* clear_m, float* scratch);
  // Returns kBlockChanged…
  unsigned (*integrate_block)(const IntegratePass* pass, const float* origin, int16_t* distance, uint16_t* weight,
                              uint8_t* color);
  CompareSum (*compare_block)(const ComparePass* pass, const float* origin, const int16_t* distance,
                              const uint16_t* weight);
};

}  // namespace povslam
