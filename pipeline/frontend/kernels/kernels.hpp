// The frontend's vector kernels: plain functions on raw pointers, compiled once per instruction set (*.kernel.cpp)
// and picked at run time (dispatch.hpp). Every set returns the same bits. Kernel sources include nothing but this,
// simd.hpp and the intrinsics: an inline library function compiled for a wider set could be merged by the linker
// into code that runs on a narrower machine.
#pragma once

#include <stdint.h>

namespace povslam {

// Bytes that a kernel may read or write past the last element it was asked for.
enum { kKernelSlack = 64 };

struct FastCorner {
  uint16_t x, y;  // px
  uint8_t score;  // the largest threshold at which the pixel is a FAST-9 corner
  float dx, dy;   // px, sub-pixel position relative to x, y; 0 as found
};

// The peak of corner response near a FAST corner.
struct CornerPeak {
  int column, row;  // px off the FAST corner, within 2
  float x, y;       // px off that pixel, within 1
  float response;   // grey levels squared, times constants of the kernel
};

// Pixels of one image: `pixels` is (0, 0), rows lie `stride` bytes apart.
struct PixelView {
  const uint8_t* pixels;
  int64_t stride;
};

// Half-open rectangle, px.
struct PixelRect {
  int x0, y0, x1, y1;
};

// Horizontal bilinear taps of eight neighbouring outputs: output i is (source[base + shuffle[2i]] * weight[2i] +
// source[base + shuffle[2i+1]] * weight[2i+1]); the weights sum to 128.
struct ShrinkTaps {
  int32_t base;
  uint8_t shuffle[16];
  int8_t weight[16];
};

enum { kPatchRadius = 15, kPatchRows = 2 * kPatchRadius + 1, kPatchColumns = 32, kBriefBits = 256 };

// Round patch around a pixel: per row, the columns -15..16 as weights (0 outside of the circle).
struct PatchMask {
  alignas(32) int8_t column[kPatchRows][kPatchColumns];   // the column's number
  alignas(32) uint8_t inside[kPatchRows][kPatchColumns];  // 255 inside
};

struct PatchMoments {
  int32_t x, y;  // sum of grey * column, sum of grey * row
};

struct FrontendKernels {
  const char* isa;
  // One row: `groups` times eight outputs, each 128 times a grey level.
  void (*shrink_row)(const uint8_t* source, const ShrinkTaps* taps, int groups, uint16_t* out);
  // (upper * (128 - weight) + lower * weight) of two such rows, as grey levels. 0 <= weight <= 127.
  void (*blend_rows)(const uint16_t* upper, const uint16_t* lower, int weight, int width, uint8_t* out);
  // One row smoothed with 7x7 weights (9 17 24 28 24 17 9) / 128 both ways; `source` has 3 valid pixels all around
  // the row, `scratch` holds width + 2 * kKernelSlack bytes.
  void (*smooth_row)(const uint8_t* source, int64_t stride, int width, uint8_t* scratch, uint8_t* out);
  // FAST-9 corners with score >= threshold that are the largest of their 3x3 neighbourhood inside `rect` (of equals
  // the first in raster order), in raster order. `scratch` holds 3 * (rect width + 2 * kKernelSlack) bytes, `corners`
  // a quarter of the rect (rounded up per axis). The image has 3 valid pixels around the rect. Returns how many.
  int (*find_corners)(PixelView image, PixelRect rect, int threshold, uint8_t* scratch, FastCorner* corners);
  // False if no peak is within reach: an edge or noise rather than a corner. Reads 8 pixels to the left of and above
  // `corner`, 9 to the right of and 8 below it.
  bool (*refine_corner)(const uint8_t* corner, int64_t stride, CornerPeak* peak);
  PatchMoments (*patch_moments)(const uint8_t* centre, int64_t stride, const PatchMask* mask);
  // Bit i = centre[first[i]] < centre[second[i]].
  void (*brief)(const uint8_t* centre, const int32_t* first, const int32_t* second, uint64_t* bits);
  void (*rgb_to_grey)(const uint8_t* rgb, uint8_t* grey, int64_t count);
};

}  // namespace povslam
