// The upright box about a cloud that shows one, two or more of its sides.
#pragma once

#include <span>

#include "pipeline/objects/observation.hpp"

namespace povslam {

// Heading by closeness of the points to the sides (Zhang et al., "Efficient L-shape fitting", IV 2017), extents by
// percentiles: `trim` of the points may lie outside at each end. Needs at least 3 points; fewer: a box without size.
Box fit_box(std::span<const Eigen::Vector3f> points, double trim);

// With the heading given.
Box fit_box_at(std::span<const Eigen::Vector3f> points, double yaw, double trim);

double fold_half_turn(double yaw);  // into (-pi/2, pi/2]

// Of upright boxes: volume of both over that of either, and over that of the smaller.
struct BoxOverlap {
  double iou = 0.0, of_smaller = 0.0;
};
BoxOverlap overlap(const Box& a, const Box& b);

}  // namespace povslam
