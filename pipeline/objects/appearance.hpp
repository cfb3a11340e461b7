// What a thing looks like, whatever its place and pose: the colours of its surface.
#pragma once

#include <array>

#include "pipeline/mapping/volume.hpp"

namespace povslam {

struct Appearance {
  static constexpr int kLevels = 5;                        // of each colour
  std::array<float, kLevels * kLevels * kLevels> share{};  // of the surface; sums to 1, all 0: not known
};

bool is_known(const Appearance& appearance);

Appearance appearance_of(const Volume& volume);

// Histogram intersection [0, 1]; of something not known: 0.
double likeness(const Appearance& a, const Appearance& b);

}  // namespace povslam
