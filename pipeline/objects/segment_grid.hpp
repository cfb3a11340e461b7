// What the steps of the geometric segmentation share: one depth image on a coarse grid, in inverse depth.
//
// A plane is linear in inverse depth over the image, and the noise of a stereo or structured light camera (sigma_z =
// q z^2) is the same everywhere in it: q. So one threshold in inverse depth serves at all distances.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/mapping/depth_view.hpp"
#include "pipeline/objects/segment.hpp"

namespace povslam {

// Cells of step x step pixels with a margin of kMargin empty cells on each side: neighbours need no check of bounds.
struct SegmentGrid {
  static constexpr int kMargin = 5;

  explicit SegmentGrid(const PinholeCamera& camera);

  int index(int column, int row) const { return (row + kMargin) * stride + column + kMargin; }
  float area_m2(int i) const;  // of the surface that a cell shows

  int step = 1;                                // pixels of the image a cell, along each side
  int width = 0, height = 0;                   // cells
  int stride = 0;                              // from one row to the next
  float focal_x, focal_y, center_x, center_y;  // in cells

  // Per cell. Level axes: those of the world, origin below the camera's centre at the world's height 0.
  std::vector<float> raw;                           // inverse depth [1/m]; 0: none
  std::vector<float> w;                             // the same, smoothed
  std::vector<float> slope_x, slope_y;              // of w, a cell
  std::vector<float> x, y, z;                       // level, m
  std::vector<float> normal_x, normal_y, normal_z;  // level, towards the camera
  std::vector<std::uint8_t> edge;                   // 1: behind a jump or in a concave fold
  std::vector<int> label;                           // kNoPart, kFloorPart …
};

inline constexpr int kNoPart = 0, kStructurePart = 1, kFirstPart = 2;

// Fills raw and w. Depths that are no numbers, negative or out of all reason count as none.
void take_depth(const DepthView& view, const SegmentOptions& options, SegmentGrid& grid);
// Fills slopes, points and normals.
void find_surfaces(const Rigid3& T_world_camera, const SegmentOptions& options, SegmentGrid& grid);
// Fills edge.
void find_edges(const SegmentOptions& options, SegmentGrid& grid);

// Standard deviation of w and of raw.
inline float smooth_sigma(const SegmentOptions& options, const SegmentGrid& grid) {
  constexpr float kMeanOf = 4.0F;  // root of the number of cells that are averaged, a few of them lost
  return static_cast<float>(options.depth_sigma_quadratic_per_m) / (kMeanOf * static_cast<float>(grid.step));
}

}  // namespace povslam
