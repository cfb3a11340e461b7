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

struct BlockInView {
  int index = 0;
  PixelBox box;            // holds all pixels it falls on
  float nearest_m = 0.0F;  // of its voxels' depths
};
// Of the blocks that lie in the picture, not wholly beyond the view's range by more than the truncation. Returns a box
// that holds all of theirs.
PixelBox blocks_in_view(const Volume& volume, const DepthView& view, const Rigid3& T_camera_volume,
                        std::vector<BlockInView>& blocks);
// Of those: not wholly behind what was measured there by more than the truncation.
std::vector<int> visible_blocks(const Volume& volume, const DepthView& view, const Rigid3& T_camera_volume);

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
