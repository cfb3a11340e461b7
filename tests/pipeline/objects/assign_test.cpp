#include "pipeline/objects/assign.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace povslam {
namespace {

struct Outcome {
  int pairs = 0;
  double cost = 0.0;
  bool operator<(const Outcome& other) const { return pairs != other.pairs ? pairs > other.pairs : cost < other.cost; }
};

Outcome outcome(const Eigen::MatrixXd& cost, const std::vector<int>& column_of) {
  Outcome out;
  for (std::size_t i = 0; i < column_of.size(); ++i) {
    if (column_of[i] < 0) continue;
    ++out.pairs;
    out.cost += cost(static_cast<Eigen::Index>(i), column_of[i]);
  }
  return out;
}

// The best of all ways to give rows distinct columns.
Outcome best_of_all(const Eigen::MatrixXd& cost, std::size_t row, std::vector<int>& column_of) {
  if (row == static_cast<std::size_t>(cost.rows())) return outcome(cost, column_of);
  column_of[row] = -1;
  Outcome best = best_of_all(cost, row + 1, column_of);
  for (int j = 0; j < cost.cols(); ++j) {
    if (cost(static_cast<Eigen::Index>(row), j) >= kForbidden) continue;
    if (std::find(column_of.begin(), column_of.begin() + static_cast<std::ptrdiff_t>(row), j) !=
        column_of.begin() + static_cast<std::ptrdiff_t>(row)) {
      continue;
    }
    column_of[row] = j;
    best = std::min(best, best_of_all(cost, row + 1, column_of));
  }
  column_of[row] = -1;
  return best;
}

TEST(Assign, MakesAsManyPairsAsPossibleAtLeastCost) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> price(0.0, 10.0);
  std::bernoulli_distribution forbidden(0.4);
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::MatrixXd cost(1 + trial % 5, 1 + trial / 5 % 6);
    for (double& entry : cost.reshaped()) entry = forbidden(random) ? 2.0 * kForbidden : price(random);
    const std::vector<int> found = assign(cost);
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (std::size_t k = i + 1; k < found.size(); ++k) EXPECT_FALSE(found[i] >= 0 && found[i] == found[k]);
    }
    std::vector<int> scratch(found.size(), -1);
    const Outcome best = best_of_all(cost, 0, scratch), got = outcome(cost, found);
    EXPECT_EQ(got.pairs, best.pairs);
    EXPECT_NEAR(got.cost, best.cost, 1e-6);
  }
}

TEST(Assign, OfNothingIsNothing) {
  EXPECT_TRUE(assign(Eigen::MatrixXd(0, 3)).empty());
  EXPECT_EQ(assign(Eigen::MatrixXd(2, 0)), std::vector<int>({-1, -1}));
}

TEST(Assign, LeavesRowsAloneThatMayGoNowhere) {
  EXPECT_EQ(assign(Eigen::MatrixXd::Constant(2, 2, kForbidden)), std::vector<int>({-1, -1}));
}

}  // namespace
}  // namespace povslam
