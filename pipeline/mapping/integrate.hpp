// Brings a depth view into a volume (Curless and Levoy 1996), by projection of the voxels.
#pragma once

#include "pipeline/mapping/depth_view.hpp"
#include "pipeline/mapping/volume.hpp"

namespace povslam {

struct IntegrateOptions {
  double depth_sigma_quadratic_per_m = 0.0025;  // sigma_z = this * z^2…
  double depth_sigma_floor_m = 0.003;  // …with this in quadrature: weight of a look is (floor / sigma)^2, capped
  double max_weight = 100.0;           // looks: older ones fade beyond
  int allocation_stride_px = 4;
};

struct IntegrateReport {
  int blocks_in_view = 0;
  int blocks_made = 0;
  int blocks_refused = 0;  // the volume is full
};

// Surfaces are taken from the owner's pixels only. Every pixel with depth, whoever's, empties the space before its
// surface: voxels of blocks already there that lie more than the truncation before it, or that show the owner's surface
// where somebody else's is seen behind it.
IntegrateReport integrate(Volume& volume, const DepthView& view, std::uint16_t owner, const Rigid3& T_world_volume,
                          const IntegrateOptions& options);

}  // namespace povslam
