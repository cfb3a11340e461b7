// Where exactly a known little piece of surface lies in an image: its look at first sight, warped to the present view
// and shifted until it fits (inverse-compositional Lucas-Kanade; Baker & Matthews, IJCV 2004). A feature detector
// places a corner to about half a pixel, anew in each image; this places it to about a tenth, always against the same
// look.
#pragma once

#include <cstdint>

#include "pipeline/frontend/orb.hpp"

namespace povslam {

inline constexpr int kPatchSide = 24;  // px of the level it was cut from; centre at (kPatchSide / 2, kPatchSide / 2)

struct Patch {
  std::uint8_t pixels[kPatchSide * kPatchSide];
};

struct PatchPlace {
  float x = 0.0F, y = 0.0F;  // px of the level looked at
  float correlation = 0.0F;  // zero-mean normalised, of patch and image at the place; 1 = identical
  bool converged = false;
};

// Cuts the patch around (x, y) px of the level. False when it would leave the image.
bool cut_patch(const PyramidLevel& level, float x, float y, Patch& patch);

// patch_per_image: 2x2 row-major, px of the patch per px of the level. (x, y): where to begin, px of the level.
// Not converged: left the image or walked further than max_shift_px, or the patch shows no structure.
PatchPlace find_patch(const Patch& patch, const float patch_per_image[4], const PyramidLevel& level, float x, float y,
                      float max_shift_px);

}  // namespace povslam
