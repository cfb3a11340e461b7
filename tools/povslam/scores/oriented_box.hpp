// Upright boxes: turned about world z only.
#pragma once

#include <Eigen/Core>

namespace povslam::scores {

struct OrientedBox {
  Eigen::Vector3d center_world = Eigen::Vector3d::Zero();
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  // edges along the box's own x, y and world z
  double yaw_rad = 0.0;
};

// Exact: convex polygons are clipped in the plane, heights are intervals.
double intersection_volume(const OrientedBox& a, const OrientedBox& b);  // m^3
double box_iou(const OrientedBox& a, const OrientedBox& b);              // 0 ... 1, 0 for boxes without volume

// No further apart than gap_m (up to the corners, where it is sqrt(2) gap_m).
bool boxes_touch(const OrientedBox& a, const OrientedBox& b, double gap_m);

// Smallest box in the attitude of `a` that holds both.
OrientedBox joined(const OrientedBox& a, const OrientedBox& b);

double yaw_difference_mod_half_turn(double a_rad, double b_rad);  // 0 ... pi/2: a box turned by 180 degrees is the same

}  // namespace povslam::scores
