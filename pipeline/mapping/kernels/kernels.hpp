// The dense map's vector kernels: plain functions on raw pointers, compiled once per instruction set (*.kernel.cpp) and
// picked at run time (dispatch.hpp). Every set returns the same bits. Kernel sources include nothing but this folder's
// headers and the intrinsics: an inline library function compiled for a wider set could be merged by the linker into
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
  float unit_m;               // of the depths in the look; those beyond kMostUnits of it count as that
};
constexpr float kMostUnits = 65000.0F;

// What a pixel says to one owner's volume, in one word: bits 0 … 15 the depth [unit] where it is mine, else 0; bits 16
// … 30 the least depth [2 units, rounded down] measured within kClearRadius, 0 where there is none; bit 31 is set where
// somebody else's surface alone is there.
using LookPixel = uint32_t;
enum { kLookScratch = 19 };

// The largest depth [unit] measured, whoever's, in each tile of the part, row by row.
enum { kLookTile = 16 };  // px
constexpr int look_tiles(int size_px) {
  return (size_px + kLookTile - 1) / kLookTile;
}

// Where a block's voxels fall: voxel (x, y, z) of it has p = origin + in_slice(x, y) + z next_slice, and lies at depth
// p[2] in pixel (p[0], p[1]) / p[2] of the part. Depths, as the distances in blocks, are in units of which the
// truncation has kFullUnits.
constexpr float kFullUnits = 32000.0F;  // as kDistanceUnits of volume.hpp
struct BlockRays {
  float in_slice[3][64];  // of x + 8 y
  float next_slice[3];
  float near;         // voxels nearer than this are not projected
  int columns, rows;  // px, of the part
};
struct BlockPlace {
  float origin[3];
  float weight_units;  // of one look at it
};

struct IntegratePass {  // the same for all blocks of a call
  BlockRays rays;
  const LookPixel* look;      // of the part, and one more that is 0
  float look_unit;            // distance units
  const uint8_t* color;       // of the part's first pixel; null: none
  const uint8_t* color_last;  // the last four bytes of the image
  int64_t color_stride;       // bytes
  int channels;               // 1 or 3
  float margin;               // with 2 sigma: how far beyond a surface is clearly beyond
  float quadratic, floor;     // (2 sigma)^2 of a depth z = quadratic z^4 + floor
  float behind_per_unit;      // slope of the weight behind a surface: 0 at the truncation, full at a voxel
  float max_weight_units;
};

// Of a block: some distance is another, or known now; some voxel behind a surface was seen empty.
enum { kBlockChanged = 1, kBlockEmptied = 2 };

struct ComparePass {
  BlockRays rays;
  const float* depth_m;  // rows lie rays.columns apart
  float units_per_m;
};
struct CompareSum {
  int64_t voxels, difference_units;
};

// Rays of a row of the image, in blocks from a corner before the camera on: first + column * along for each metre of
// depth, from `start` on.
struct RayBlocks {
  float start[3], first[3], along[3];
  float ahead_m;  // beyond the surfaces
};
enum { kKeyBits = 10 };

struct MappingKernels {
  // columns x rows pixels, and their tiles. scratch: kLookScratch * (columns + 2 * kClearRadius) values.
  void (*make_look)(const LookSource* source, LookPixel* look, uint16_t* farthest, uint16_t* scratch);
  // Returns kBlockChanged…
  unsigned (*integrate_block)(const IntegratePass* pass, const BlockPlace* place, int16_t* distance, uint16_t* weight,
                              uint8_t* color);
  CompareSum (*compare_block)(const ComparePass* pass, const float* origin, const int16_t* distance,
                              const uint16_t* weight);
  // kKeyBits each of x, y, z: the blocks of `count` rays, those alone that differ from the one before. Returns how
  // many. keys, scratch: room for count + 16.
  int (*find_keys)(const RayBlocks* rays, const float* depth_m, const float* column, int count, uint32_t* keys,
                   uint32_t* scratch);
};

}  // namespace povslam
