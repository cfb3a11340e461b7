// A part of an object that was taken while the rest still stands: one box of two that were seen as one.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/objects/object.hpp"

namespace povslam {

struct MissingPart {
  std::vector<SurfacePoint> surface;  // of the part
  std::vector<SurfacePoint> rest;     // of what stays
  Box box, rest_box;                  // volume frame
};

// Counts for each surface point the views in a row that saw through it. looks: look_at_each() of this view.
void count_missed(MapObject& object, std::span<const PointLook> looks);

// The largest connected part of the surface that several views in a row saw through, if it is at least min_m large in
// two directions, is clear of what was seen to stand, and this view sees the rest standing; else nothing.
std::optional<MissingPart> find_missing_part(const MapObject& object, std::span<const PointLook> looks, double min_m,
                                             double deepest_m);

// Takes the voxels nearer to the part than to the rest out of the object's volume. Surface and box of the object are to
// be refreshed. Returns what was taken, in the same frame.
Volume cut_out(MapObject& object, const MissingPart& part);

// Takes the voxels out for which goes() holds.
Volume cut_out(Volume& volume, const std::function<bool(const Eigen::Vector3f& p_volume)>& goes);

}  // namespace povslam
