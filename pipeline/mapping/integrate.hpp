// Brings a depth view into a volume (Curless and Levoy 1996), by projection of the voxels.
#pragma once

#include "pipeline/mapping/depth_view.hpp"
#include "pipeline/mapping/volume.hpp"

namespace povslam {

struct IntegrateOptions {
  double depth_sigma_quadratic_per_m = 0.0025;  // sigma_z = this * z^2…
  double depth_sigma_floor_m = 0.003;           // …with this in quadrature
  double max_weight = 100.0;                    // looks: older ones fade beyond
  int allocation_stride_px = 4;
};

// One look, the unit of weights: of a surface so near that sigma_z is at most this. From further it weighs less, by
// (this / sigma_z)^2, but at least 1 / kWeightUnits.
inline constexpr double kGoodSigma_m = 0.01;

struct IntegrateReport {
  int blocks_in_view = 0;
  int blocks_made = 0;
  int blocks_refused = 0;  // the volume is full
  int blocks_removed = 0;  // the last surface in and beside them has gone
};

// Surfaces are taken from the owner's pixels only. Every pixel with depth, whoever's, empties the space before its
// surface: voxels of blocks already there that lie more than the truncation before it; where all pixels around are
// somebody else's, also those that tell of a surface of the owner's clearly (half a voxel and 2 sigma) before it. The
// least depth of the 5 x 5 pixels around counts, so that edges are not eaten away. What is hidden stays as it is.
IntegrateReport integrate(Volume& volume, const DepthView& view, std::uint16_t owner, const Rigid3& T_world_volume,
                          const IntegrateOptions& options);

}  // namespace povslam
