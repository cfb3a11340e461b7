// Small pictures on the faces of things, sampled smoothly at any distance: bilinear within a level, linear between
// the two nearest levels of a mip pyramid, so that images do not alias.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace povslam::synthetic {

using Texel = std::uint32_t;  // 0x00BBGGRR

constexpr Texel make_texel(int red, int green, int blue) {
  const auto byte = [](int value) { return static_cast<Texel>(std::clamp(value, 0, 255)); };
  return byte(red) | byte(green) << 8 | byte(blue) << 16;
}

struct MipLevel {
  std::uint32_t offset = 0;  // into Texture::texels
  std::int32_t width = 1, height = 1;
};

class Texture {
 public:
  static constexpr int kMaxLevels = 12;
  static constexpr int kMaxSide = 2000;  // texels; keeps 20-bit coordinates within 32 bits

  Texture() = default;
  Texture(int width, int height, std::vector<Texel> texels);  // builds the pyramid
  static std::size_t num_texels(int width, int height);       // of the whole pyramid

  int width() const { return levels_[0].width; }
  int height() const { return levels_[0].height; }
  const Texel* texels() const { return texels_.data(); }
  const std::array<MipLevel, kMaxLevels>& levels() const { return levels_; }
  int num_levels() const { return num_levels_; }

 private:
  std::vector<Texel> texels_;
  std::array<MipLevel, kMaxLevels> levels_{};
  int num_levels_ = 0;
};

// Four 16-bit lanes (red, blue, green, none) hold 8-bit values, so that one multiplication weighs all channels.
using Lanes = std::uint64_t;
inline constexpr Lanes kLaneMask = 0x00FF00FF00FF00FFULL;

constexpr Lanes to_lanes(Texel texel) {
  return (Lanes{texel} | Lanes{texel} << 24) & kLaneMask;
}
constexpr Lanes blend(Lanes a, Lanes b, std::uint32_t weight_b_256) {
  return ((a * (256 - weight_b_256) + b * weight_b_256) >> 8) & kLaneMask;
}
struct Rgb {
  int red = 0, green = 0, blue = 0;
};
constexpr Rgb from_lanes(Lanes lanes) {
  return {static_cast<int>(lanes & 0xFF), static_cast<int>(lanes >> 32 & 0xFF), static_cast<int>(lanes >> 16 & 0xFF)};
}

inline constexpr int kCoordinateBits = 20;  // s, t: 0 … 1 as 0 … 2^20

inline Lanes sample_level(const Texel* texels, const MipLevel& level, std::int32_t s20, std::int32_t t20) {
  const auto place = [](std::int32_t coordinate, std::int32_t size) {
    const auto at_256 = static_cast<std::int32_t>((std::int64_t{coordinate} * size) >> (kCoordinateBits - 8)) - 128;
    return std::clamp(at_256, 0, (size - 1) * 256);
  };
  const std::int32_t u = place(s20, level.width), v = place(t20, level.height);
  const Texel* top = texels + level.offset + (v >> 8) * level.width + (u >> 8);
  const int right = (u >> 8) + 1 < level.width ? 1 : 0;
  const Texel* bottom = (v >> 8) + 1 < level.height ? top + level.width : top;
  const auto fu = static_cast<std::uint32_t>(u & 255), fv = static_cast<std::uint32_t>(v & 255);
  return blend(blend(to_lanes(top[0]), to_lanes(top[right]), fu),
               blend(to_lanes(bottom[0]), to_lanes(bottom[right]), fu), fv);
}

// level_256: 256 times the base-2 logarithm of the texels (of level 0) one pixel covers.
inline Lanes sample(const Texture& texture, std::int32_t s20, std::int32_t t20, std::int32_t level_256) {
  const Texel* texels = texture.texels();
  const auto& levels = texture.levels();
  if (level_256 <= 0) return sample_level(texels, levels[0], s20, t20);
  const int level = level_256 >> 8;
  if (level + 1 >= texture.num_levels()) {
    return sample_level(texels, levels[static_cast<std::size_t>(texture.num_levels() - 1)], s20, t20);
  }
  const auto fine = static_cast<std::size_t>(level);
  return blend(sample_level(texels, levels[fine], s20, t20), sample_level(texels, levels[fine + 1], s20, t20),
               static_cast<std::uint32_t>(level_256 & 255));
}

}  // namespace povslam::synthetic
