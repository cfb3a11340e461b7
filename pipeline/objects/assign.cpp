#include "pipeline/objects/assign.hpp"

#include <limits>

namespace povslam {
namespace {

// Shortest augmenting paths with potentials (Jonker and Volgenant 1987), rows <= columns.
std::vector<int> assign_wide(const Eigen::MatrixXd& cost) {
  const auto n = static_cast<std::size_t>(cost.rows()), m = static_cast<std::size_t>(cost.cols());
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<double> u(n + 1, 0.0), v(m + 1, 0.0);
  std::vector<std::size_t> row_of(m + 1, 0), way(m + 1, 0);  // 1-based; column 0 starts a path
  for (std::size_t i = 1; i <= n; ++i) {
    row_of[0] = i;
    std::size_t column = 0;
    std::vector<double> least(m + 1, kInfinity);
    std::vector<bool> used(m + 1, false);
    do {
      used[column] = true;
      const std::size_t row = row_of[column];
      double delta = kInfinity;
      std::size_t next = 0;
      for (std::size_t j = 1; j <= m; ++j) {
        if (used[j]) continue;
        const double reduced =
            cost(static_cast<Eigen::Index>(row - 1), static_cast<Eigen::Index>(j - 1)) - u[row] - v[j];
        if (reduced < least[j]) least[j] = reduced, way[j] = column;
        if (least[j] < delta) delta = least[j], next = j;
      }
      for (std::size_t j = 0; j <= m; ++j) {
        if (used[j])
          u[row_of[j]] += delta, v[j] -= delta;
        else
          least[j] -= delta;
      }
      column = next;
    } while (row_of[column] != 0);
    for (; column != 0; column = way[column]) row_of[column] = row_of[way[column]];
  }
  std::vector<int> column_of(n, -1);
  for (std::size_t j = 1; j <= m; ++j) {
    if (row_of[j] != 0) column_of[row_of[j] - 1] = static_cast<int>(j - 1);
  }
  return column_of;
}

}  // namespace

std::vector<int> assign(const Eigen::MatrixXd& cost) {
  std::vector<int> column_of(static_cast<std::size_t>(cost.rows()), -1);
  if (cost.rows() == 0 || cost.cols() == 0) return column_of;
  const Eigen::MatrixXd capped = cost.cwiseMin(kForbidden);
  if (cost.rows() <= cost.cols()) {
    column_of = assign_wide(capped);
  } else {
    const std::vector<int> row_of = assign_wide(capped.transpose());
    for (std::size_t j = 0; j < row_of.size(); ++j)
      column_of[static_cast<std::size_t>(row_of[j])] = static_cast<int>(j);
  }
  for (std::size_t i = 0; i < column_of.size(); ++i) {
    if (column_of[i] >= 0 && !(cost(static_cast<Eigen::Index>(i), column_of[i]) < kForbidden)) column_of[i] = -1;
  }
  return column_of;
}

}  // namespace povslam
