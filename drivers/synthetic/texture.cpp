#include "drivers/synthetic/texture.hpp"

#include <utility>

#include "pipeline/base/expects.hpp"

namespace povslam::synthetic {

namespace {

int mean_of_four(Texel a, Texel b, Texel c, Texel d, int shift) {
  const auto channel = [shift](Texel texel) { return static_cast<int>(texel >> shift & 0xFF); };
  return (channel(a) + channel(b) + channel(c) + channel(d) + 2) / 4;
}

}  // namespace

std::size_t Texture::num_texels(int width, int height) {
  std::size_t sum = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (int level = 1; level < kMaxLevels && (width > 1 || height > 1); ++level) {
    width = std::max(1, width / 2);
    height = std::max(1, height / 2);
    sum += static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  return sum;
}

Texture::Texture(int width, int height, std::vector<Texel> texels) : texels_(std::move(texels)) {
  EXPECTS(width > 0 && height > 0 && width <= kMaxSide && height <= kMaxSide);
  EXPECTS(texels_.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  texels_.reserve(num_texels(width, height));
  levels_[0] = {0, width, height};
  num_levels_ = 1;
  while (num_levels_ < kMaxLevels && (width > 1 || height > 1)) {
    const MipLevel from = levels_[static_cast<std::size_t>(num_levels_ - 1)];
    width = std::max(1, width / 2);
    height = std::max(1, height / 2);
    levels_[static_cast<std::size_t>(num_levels_++)] = {static_cast<std::uint32_t>(texels_.size()), width, height};
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const auto at = [&](int dx, int dy) {
          const int u = std::min(2 * x + dx, from.width - 1), v = std::min(2 * y + dy, from.height - 1);
          return texels_[from.offset + static_cast<std::size_t>(v) * static_cast<std::size_t>(from.width) +
                         static_cast<std::size_t>(u)];
        };
        const Texel a = at(0, 0), b = at(1, 0), c = at(0, 1), d = at(1, 1);
        texels_.push_back(
            make_texel(mean_of_four(a, b, c, d, 0), mean_of_four(a, b, c, d, 8), mean_of_four(a, b, c, d, 16)));
      }
    }
  }
}

}  // namespace povslam::synthetic
