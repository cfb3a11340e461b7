// Least-cost one-to-one assignment (Hungarian method).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace povslam {

// cost(row, column); kForbidden or more: that pair is never made. By row: its column, -1: none. As many pairs as can be
// made, at least cost. O(n^2 m).
inline constexpr double kForbidden = 1e6;
std::vector<int> assign(const Eigen::MatrixXd& cost);

}  // namespace povslam
