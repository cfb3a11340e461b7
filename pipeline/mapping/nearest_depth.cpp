#include "pipeline/mapping/nearest_depth.hpp"

#include <algorithm>

namespace povslam {

namespace {

constexpr int kFirstShift = 2;  // tiles of the first level: 4 pixels
constexpr int kLevels = 6;

}  // namespace

NearestDepth::NearestDepth(const ImageF& depth_m) {
  const auto tiles = [](int size) { return (size + (1 << kFirstShift) - 1) >> kFirstShift; };
  ImageF& first = levels_.emplace_back(tiles(depth_m.width()), tiles(depth_m.height()));
  first.fill(kNothing_m);
  std::vector<float> least(static_cast<std::size_t>(first.width()) << kFirstShift);
  for (int top = 0; top < depth_m.height(); top += 1 << kFirstShift) {
    std::fill(least.begin(), least.end(), kNothing_m);
    for (int y = top; y < std::min(top + (1 << kFirstShift), depth_m.height()); ++y) {
      const float* depth = depth_m.row(y);
      float* of_column = least.data();  // without branches: the loop becomes vectors
      for (int x = 0; x < depth_m.width(); ++x) {
        const float measured = depth[x] > 0.0F ? depth[x] : kNothing_m;
        of_column[x] = measured < of_column[x] ? measured : of_column[x];
      }
    }
    float* tile = first.row(top >> kFirstShift);
    for (std::size_t x = 0; x < least.size(); ++x) tile[x >> kFirstShift] = std::min(tile[x >> kFirstShift], least[x]);
  }
  levels_.reserve(kLevels);
  for (int k = 1; k < kLevels; ++k) {
    const ImageF& fine = levels_.back();
    ImageF coarse((fine.width() + 1) / 2, (fine.height() + 1) / 2);
    coarse.fill(kNothing_m);
    for (int y = 0; y < fine.height(); ++y) {
      for (int x = 0; x < fine.width(); ++x) {
        coarse.at(x / 2, y / 2) = std::min(coarse.at(x / 2, y / 2), fine.at(x, y));
      }
    }
    levels_.push_back(std::move(coarse));
  }
}

float NearestDepth::within(const PixelBox& box) const {
  const int longer = std::max(box.columns(), box.rows());
  int level = 0;
  while (level + 1 < kLevels && longer > 4 << (kFirstShift + level)) ++level;
  const int shift = kFirstShift + level;
  const ImageF& tiles = levels_[static_cast<std::size_t>(level)];
  float least = kNothing_m;
  for (int y = box.y0 >> shift; y <= (box.y1 - 1) >> shift; ++y) {
    for (int x = box.x0 >> shift; x <= (box.x1 - 1) >> shift; ++x) least = std::min(least, tiles.at(x, y));
  }
  return least;
}

}  // namespace povslam
