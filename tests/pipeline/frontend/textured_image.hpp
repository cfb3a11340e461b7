// A deterministic grey image of overlapping rectangles and a little noise: corners everywhere, at several sizes.
#pragma once

#include <cstdint>
#include <random>

#include "pipeline/frames/image.hpp"

namespace povslam {

inline ImageU8 textured_image(int width, int height, unsigned seed = 1) {
  std::mt19937 random(seed);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  ImageU8 image(width, height);
  image.fill(120);
  for (int k = 0; k < width * height / 300; ++k) {
    const int x0 = below(width), y0 = below(height), grey = below(256);
    const int x1 = std::min(width, x0 + 3 + below(40)), y1 = std::min(height, y0 + 3 + below(40));
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) image.at(x, y) = static_cast<std::uint8_t>(grey);
    }
  }
  for (std::uint8_t& pixel : image.pixels()) pixel = static_cast<std::uint8_t>(pixel * 15 / 16 + below(9));
  return image;
}

}  // namespace povslam
