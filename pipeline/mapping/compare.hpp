// The surface a volume expects against the one a view observes.
#pragma once

#include <span>
#include <vector>

#include "pipeline/mapping/depth_view.hpp"
#include "pipeline/mapping/volume.hpp"

namespace povslam {

struct DistanceComparison {
  int voxels = 0;                  // V: seen in both, within the truncation of the model's surface
  double mean_difference_m = 0.0;  // mean over V of |D_observed - D_model|
};
// Geometric change of an object without its factor lambda_diff (POCD as in the design's method 1.4). D_observed is the
// projective distance of the view's pixel, of whichever owner; voxels behind a surface by more than the truncation are
// hidden and do not count. Nor do those that the model holds for free: there the surface would be a neighbour's, or the
// floor.
DistanceComparison compare_distances(const Volume& volume, const DepthView& view, const Rigid3& T_world_volume);

struct SurfacePoint {
  Eigen::Vector3f p_volume = Eigen::Vector3f::Zero();  // m
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();    // unit, out of the surface
};
// About one point for each voxel the zero crossing passes, where it was seen at least min_weight looks. Borders between
// free and never seen space are left out.
std::vector<SurfacePoint> surface_points(const Volume& volume, double min_weight);

struct SurfaceLook {  // of an expected surface's points, facing the camera by more than about 75 degrees, in one view
  int facing = 0;     // all of them, in the image and its range
  int agree = 0;      // a depth measured in the 3 x 3 pixels around is theirs
  int seen_through = 0;        // the camera measured something clearly behind them
  int hidden = 0;              // something stands clearly before them
  double mean_beyond_m = 0.0;  // of those seen through: how far behind, at most 1 m each
};
// Clearly: by more than margin_m + 3 sigma(z) for every measured pixel of the 3 x 3 around; pixels without depth do not
// count. A point whose pixels are partly before it and partly behind is none of the three.
SurfaceLook look_at(std::span<const SurfacePoint> surface, const DepthView& view, const Rigid3& T_world_volume,
                    double margin_m, const DepthNoise& noise = {});

// What look_at() counts, by point; nothing: it does not face the camera, or its pixels say neither.
enum class PointLook : std::uint8_t { nothing, agrees, seen_through, hidden };
std::vector<PointLook> look_at_each(std::span<const SurfacePoint> surface, const DepthView& view,
                                    const Rigid3& T_world_volume, double margin_m, const DepthNoise& noise = {});

}  // namespace povslam
