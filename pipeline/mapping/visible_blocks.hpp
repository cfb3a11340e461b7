// Which blocks of a volume a view may say something about, and where they lie in it.
#pragma once

#include <vector>

#include "pipeline/mapping/depth_view.hpp"
#include "pipeline/mapping/kernels/kernels.hpp"
#include "pipeline/mapping/volume.hpp"

namespace povslam {

struct PixelBox {  // of an image: columns x0 … x1 - 1
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int columns() const { return x1 - x0; }
  int rows() const { return y1 - y0; }
};

// The largest depth measured in each tile of kTile x kTile pixels.
class FarthestDepth {
 public:
  static constexpr int kTile = 32;

  explicit FarthestDepth(const ImageF& depth_m);
  float within(const PixelBox& box) const;  // not empty, in the image; and of some pixels around
  const std::uint8_t* measured() const { return measured_.data(); }  // of each row, with its tiles: 0 if nothing was

 private:
  float& at(int x, int y) { return farthest_m_[static_cast<std::size_t>(y * columns_ + x)]; }
  float at(int x, int y) const { return farthest_m_[static_cast<std::size_t>(y * columns_ + x)]; }
  int columns_;
  std::vector<float> farthest_m_;
  std::vector<std::uint8_t> measured_;
};

struct VisibleBlocks {
  std::vector<int> indices;
  PixelBox box;  // holds all pixels they fall on
};
// Of the blocks that lie in the picture, not wholly behind what was measured there by more than the truncation.
VisibleBlocks visible_blocks(const Volume& volume, const DepthView& view, const FarthestDepth& farthest,
                             const Rigid3& T_camera_volume);

// Projection of voxel centres into pixels of `box`, with depths in the volume's distance units.
class VoxelProjection {
 public:
  VoxelProjection(const Volume& volume, const PinholeCamera& camera, const PixelBox& box,
                  const Rigid3& T_camera_volume);
  BlockRays rays() const;
  Eigen::Vector3f origin(const BlockKey& key) const;  // of its voxel 0
  float centre_depth_m(const BlockKey& key) const;

 private:
  PixelBox box_;
  double voxel_size_m_, units_per_m_;
  Eigen::Matrix3d rotation_;  // volume [m] to pixel times depth
  Eigen::Vector3d translation_;
};

}  // namespace povslam
