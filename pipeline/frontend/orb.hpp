// ORB features (Rublee et al., ICCV 2011) on an image pyramid, spread evenly over cells and levels.
// Own vector kernels do the work (kernels/): no OpenCV, no Eigen, no allocation after construction.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace povslam {

struct FrontendKernels;

struct OrbOptions {
  int num_features = 1000;     // wanted; what the image yields may be less
  int num_levels = 8;          // pyramid levels
  double scale_factor = 1.2;   // size ratio of neighbouring levels
  int fast_threshold = 20;     // grey levels: first choice of a cell
  int min_fast_threshold = 7;  // grey levels: what a poor cell is lowered to, for half its share
  int cell_px = 32;            // cell edge on each level over which features are spread
};

inline constexpr int kMaxPyramidLevels = 12;
inline constexpr int kOrbBorder = 16;  // px around each pyramid level

using Descriptor = std::array<std::uint64_t, 4>;  // 256 bits

// Structure of arrays, capacity fixed at construction. Positions are sub-pixel, in level-0 pixels as delivered
// (distorted).
struct OrbFeatures {
  explicit OrbFeatures(int capacity = 0);
  int capacity = 0;
  int size = 0;
  std::vector<float> x, y;          // px, level 0
  std::vector<float> angle;         // rad, direction of the intensity centroid, (-pi, pi]
  std::vector<float> response;      // FAST score, grey levels
  std::vector<std::uint8_t> level;  // pyramid level
  std::vector<Descriptor> descriptor;
};

// One pyramid level: grey pixels, row-major. `pixels` points to (0, 0); a border of kOrbBorder valid (replicated)
// pixels lies around.
struct PyramidLevel {
  int width = 0, height = 0;  // px
  std::int64_t stride = 0;    // bytes between rows
  const std::uint8_t* pixels = nullptr;
  float scale = 1.0F;  // level-0 px per px of this level: x0 = (x + 0.5) * scale - 0.5
};

// A part of the image, level-0 px, where features are wanted more than elsewhere.
struct FeatureWish {
  float x0 = 0.0F, y0 = 0.0F, x1 = 0.0F, y1 = 0.0F;
};

class OrbExtractor {
 public:
  // On the widest instruction set this machine has, or on given kernels (kernels/dispatch.hpp).
  OrbExtractor(int width, int height, const OrbOptions& options);
  OrbExtractor(int width, int height, const OrbOptions& options, const FrontendKernels& kernels);
  ~OrbExtractor();
  OrbExtractor(OrbExtractor&&) noexcept;
  OrbExtractor& operator=(OrbExtractor&&) noexcept;

  // grey: height rows of width bytes, `stride` bytes apart. Features come sorted by level, then cell row, then cell.
  // Deterministic; the same on every instruction set. Cells that lie in a wish get twice the share of others.
  void extract(const std::uint8_t* grey, std::int64_t stride, OrbFeatures& features,
               std::span<const FeatureWish> wishes = {});

  // Levels of the last image, valid until the next extract().
  int num_levels() const;
  const PyramidLevel& level(int index) const;
  float scale(int index) const;  // = scale_factor ^ index

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

inline int hamming_distance(const Descriptor& a, const Descriptor& b) {  // bits
  int bits = 0;
  for (std::size_t k = 0; k < 4; ++k) bits += __builtin_popcountll(a[k] ^ b[k]);
  return bits;
}

// Colour to grey as ITU-R BT.601 (0.299 R + 0.587 G + 0.114 B), rounded. rgb interleaved, count pixels.
void rgb_to_grey(const std::uint8_t* rgb, std::uint8_t* grey, std::int64_t count);

// Index of the nearest descriptor to `query` among `count` in `candidates`, and its distance and the runner-up's.
struct NearestDescriptor {
  int index = -1;
  int distance = 257;
  int second_distance = 257;
};
NearestDescriptor nearest_descriptor(const Descriptor& query, const Descriptor* candidates, int count);

}  // namespace povslam
