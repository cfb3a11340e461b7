// From moments of constant points to blocks of the normal equations: J = [I, -[a]x] of a pose, a = R d, and [I, S R l]
// of an object (position, yaw), S a quarter turn about z. Rotations are applied to the sums.
#pragma once

#include <Eigen/Geometry>

#include "pipeline/backend/kernels/kernels.hpp"
#include "pipeline/geometry/rigid.hpp"

namespace povslam {

using Moments4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
using Moments43 = Eigen::Matrix<double, 4, 3, Eigen::RowMajor>;
using Block64 = Eigen::Matrix<double, 6, 4>;

double total(const Quad& quad);      // of its lanes
Moments4 total4(const Quad* quads);  // 16 by row

// sum c J_t^T J_s for poses t, s from sum c [1; d_t] [1; d_s]^T.
Matrix6d pose_pose(const Moments4& m, const Eigen::Matrix3d& R_t, const Eigen::Matrix3d& R_s);
// sum c J_t^T J_o from sum c [1; d_t] [1; lx; ly]^T.
Block64 pose_object(const Moments43& m, const Eigen::Matrix3d& R_t, const Eigen::Rotation2Dd& R_o);
// sum c J_o^T J_o from sum c, c lx, c ly, c (lx^2 + ly^2).
Eigen::Matrix4d object_object(const double* m, const Eigen::Rotation2Dd& R_o);

}  // namespace povslam
