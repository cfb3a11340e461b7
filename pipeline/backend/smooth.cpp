#include "pipeline/backend/smooth.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <memory>

#include "pipeline/backend/silence_ceres.hpp"
#include "pipeline/backend/smooth_window.hpp"

namespace povslam {

namespace {

constexpr int kMaxDensePoses = 200;       // free; above, a sparse reduced camera matrix is worth its bookkeeping
constexpr double kRoughTolerance = 1e-3;  // relative change of the cost that ends the first round
constexpr double kFineTolerance = 1e-4;   // and the second
constexpr double kMinShareFitting = 0.5;  // of the observations, for the answer to be believed

// What takes part in a round, by its place in the window.
struct Parts {
  std::vector<char> poses, points;
  int num_free_poses = 0;
};

Parts parts_of(const SmoothProblem& problem, const SmoothWindow& window) {
  Parts parts{std::vector<char>(window.poses.size(), 0), std::vector<char>(window.points.size(), 0)};
  for (std::size_t i = 0; i < window.used.size(); ++i) {
    if (window.used[i] == 0) continue;
    parts.poses[problem.observations[i].pose] = 1;
    parts.points[problem.observations[i].point] = 1;
  }
  for (std::size_t i = 0; i < parts.poses.size(); ++i) {
    parts.num_free_poses += parts.poses[i] != 0 && !problem.poses[i].fixed ? 1 : 0;
  }
  return parts;
}

ceres::Problem::Options problem_options() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;  // valid() has looked
  return options;
}

// Points are eliminated first, each by itself; what remains are 6 unknowns per free pose.
ceres::Solver::Options solver_options(SmoothWindow& window, const Parts& parts, const SmoothOptions& options,
                                      double tolerance) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = parts.num_free_poses <= kMaxDensePoses ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = tolerance;
  solver.num_threads = std::max(1, options.num_threads);
  solver.logging_type = ceres::SILENT;
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (std::size_t i = 0; i < parts.points.size(); ++i) {
    if (parts.points[i] != 0) solver.linear_solver_ordering->AddElementToGroup(window.points[i].data(), 0);
  }
  for (std::size_t i = 0; i < parts.poses.size(); ++i) {
    if (parts.poses[i] != 0) solver.linear_solver_ordering->AddElementToGroup(window.poses[i].data(), 1);
  }
  return solver;
}

// One round of robust least squares over the observations in use, in place. False when Ceres has no answer.
bool solve_round(SmoothProblem& problem, SmoothWindow& window, const SmoothOptions& options, double tolerance) {
  const Parts parts = parts_of(problem, window);
  PoseManifold manifold;
  ceres::HuberLoss pixel_loss(options.huber_pixel), depth_loss(options.huber_depth);
  ceres::Problem round(problem_options());
  for (std::size_t i = 0; i < window.used.size(); ++i) {
    if (window.used[i] == 0) continue;
    const auto& seen = problem.observations[i];
    double *pose = window.poses[seen.pose].data(), *point = window.points[seen.point].data();
    round.AddResidualBlock(&window.pixels[i], &pixel_loss, pose, point);
    if (window.depth_used[i] != 0) round.AddResidualBlock(&window.depths[i], &depth_loss, pose, point);
  }
  for (std::size_t i = 0; i < parts.poses.size(); ++i) {
    if (parts.poses[i] == 0) continue;
    round.SetManifold(window.poses[i].data(), &manifold);
    if (problem.poses[i].fixed) round.SetParameterBlockConstant(window.poses[i].data());
  }
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(window, parts, options, tolerance), &round, &summary);
  problem.iterations += summary.num_successful_steps + summary.num_unsuccessful_steps;
  return summary.IsSolutionUsable() && window.finite();
}

bool anything_to_move(const SmoothProblem& problem, const SmoothWindow& window) {
  const bool asks_for_poses = !std::ranges::all_of(problem.poses, &SmoothProblem::Pose::fixed);
  const bool any_used = std::ranges::any_of(window.used, [](char used) { return used != 0; });
  return any_used && (!asks_for_poses || parts_of(problem, window).num_free_poses > 0);
}

bool run_rounds(SmoothProblem& problem, SmoothWindow& window, const SmoothOptions& options) {
  window.leave_out_undetermined();
  if (!anything_to_move(problem, window)) return false;
  if (!solve_round(problem, window, options, kRoughTolerance)) return false;
  window.leave_out_outliers(options);
  window.leave_out_undetermined();
  if (!anything_to_move(problem, window)) return false;
  return solve_round(problem, window, options, kFineTolerance);
}

bool most_fit(const SmoothWindow& window, const SmoothOptions& options) {
  std::size_t num_fitting = 0;
  for (std::size_t i = 0; i < window.used.size(); ++i) num_fitting += window.pixel_fits(i, options) ? 1 : 0;
  return static_cast<double>(num_fitting) >= kMinShareFitting * static_cast<double>(window.used.size());
}

void adopt(const SmoothWindow& window, const SmoothOptions& options, SmoothProblem& problem) {
  for (std::size_t i = 0; i < window.poses.size(); ++i) {
    auto& pose = problem.poses[i];
    if (!pose.fixed) pose.T_world_camera = from_block(window.poses[i]);
  }
  for (std::size_t i = 0; i < window.points.size(); ++i) problem.points[i].p_world = window.points[i];
  for (std::size_t i = 0; i < window.used.size(); ++i) problem.observations[i].outlier = !window.pixel_fits(i, options);
}

}  // namespace

void smooth(SmoothProblem& problem, const SmoothOptions& options) {
  silence_ceres();
  problem.converged = false;
  problem.iterations = 0;
  problem.cost_before = problem.cost_after = 0.0;
  if (!valid(problem)) return;
  SmoothWindow window(problem);
  problem.cost_before = problem.cost_after = window.robust_cost(options);
  if (!run_rounds(problem, window, options)) return;
  window.restore_unbelievable_points();
  if (!most_fit(window, options)) return;
  problem.cost_after = window.robust_cost(options);
  adopt(window, options, problem);
  problem.converged = true;
}

}  // namespace povslam
