// Least-squares rigid alignment of paired points (Horn / Umeyama without scale).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "pipeline/geometry/rigid.hpp"

namespace povslam {

// T_a_b minimising sum |a_i - T_a_b b_i|^2. Nothing for fewer than 3 pairs, numbers that are not finite, or points on
// one line (within about 3e-5 of their extent) when allow_degenerate is false. Allocation-free.
std::optional<Rigid3> align_points(std::span<const Eigen::Vector3d> points_a, std::span<const Eigen::Vector3d> points_b,
                                   bool allow_degenerate = false);

}  // namespace povslam
