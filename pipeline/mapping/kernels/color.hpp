// Colours of voxels. Only for *.kernel.cpp.
#pragma once

#include "pipeline/mapping/kernels/rays.hpp"

namespace povslam::POVSLAM_ISA {

// Of kLanes pixels: from bytes from pass.color on to colours, red in the lowest byte, then green, blue.
POVSLAM_INLINE void read_pixels(const IntegratePass& pass, uint32_t* at) {
  for (int k = 0; k < kLanes; ++k) {
    const uint8_t* pixel = pass.color + at[k];
    uint32_t color;
    if (pass.channels == 1) {
      color = *pixel * 0x010101U;
    } else if (pixel > pass.color_last) {
      color = pixel[0] | static_cast<uint32_t>(pixel[1]) << 8 | static_cast<uint32_t>(pixel[2]) << 16;
    } else {
      __builtin_memcpy(&color, pixel, sizeof color);
    }
    __asm__("" : "+r"(color));  // or the compiler makes gathers of it
    at[k] = color;
  }
}

POVSLAM_INLINE Ints blend_channel(Ints have, Ints seen, int channel, Floats share) {
  const Floats old = to_floats(and_bits(shift_right(have, 8 * channel), 255));
  const Floats wanted = to_floats(and_bits(shift_right(seen, 8 * channel), 255));
  return shift_left(round_to_int(old + (wanted - old) * share), 8 * channel);
}

// Of the lanes in `mask`; share: how much the new look counts. color: of the first lane's voxel.
// A colour moves by at least an eighth, or old looks would hold it for ever. Black: none yet, taken over at once.
POVSLAM_INLINE void blend_colors(Ints seen, Mask mask, Floats share, uint8_t* color) {
  const Ints have = load_triples(color);
  share = select(above(have, fill_int(0)), greater(share, fill(0.125F)), fill(1.0F));
  const Ints mixed = or_bits(blend_channel(have, seen, 0, share),
                             or_bits(blend_channel(have, seen, 1, share), blend_channel(have, seen, 2, share)));
  store_triples(color, select(mask, mixed, have));
}

}  // namespace povslam::POVSLAM_ISA
