#include "pipeline/backend/close_loop.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <vector>

#include "pipeline/backend/factors/pose_manifold.hpp"
#include "pipeline/backend/factors/relative_pose_factor.hpp"
#include "pipeline/backend/silence_ceres.hpp"

namespace povslam {

namespace {

constexpr double kMaxUnitError = 1e-3;    // of a quaternion's norm
constexpr double kRoughTolerance = 1e-3;  // relative change of the cost that ends the first round
constexpr double kFineTolerance = 1e-6;   // and the second
// Drift is spread along the whole chain by motions that bend each edge hardly at all: damping would creep there.
constexpr double kTrustRegionRadius = 1e10;

RelativePose measured(const LoopProblem::Edge& edge) {
  return {edge.T_from_to, edge.sigma_m, edge.sigma_rad};
}

bool valid(const Rigid3& T) {
  return T.translation.allFinite() && std::abs(T.rotation.norm() - 1.0) < kMaxUnitError;
}

bool valid(const LoopProblem::Edge& edge, std::ptrdiff_t num_poses) {
  return edge.from >= 0 && edge.from < num_poses && edge.to >= 0 && edge.to < num_poses && edge.from != edge.to &&
         valid(edge.T_from_to) && std::isfinite(edge.sigma_m) && edge.sigma_m > 0.0 && std::isfinite(edge.sigma_rad) &&
         edge.sigma_rad > 0.0;
}

// Whether edges join each pose to a fixed one. Sets of joined poses as trees; a fixed pose stays the root of its set.
bool all_held(const LoopProblem& problem) {
  std::vector<std::size_t> parent(problem.poses.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root_of = [&parent](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const LoopProblem::Edge& edge : problem.edges) {
    const std::size_t a = root_of(static_cast<std::size_t>(edge.from));
    const std::size_t b = root_of(static_cast<std::size_t>(edge.to));
    if (a == b) continue;
    (problem.poses[a].fixed ? parent[b] : parent[a]) = problem.poses[a].fixed ? a : b;
  }
  for (std::size_t i = 0; i < parent.size(); ++i) {
    if (!problem.poses[root_of(i)].fixed) return false;
  }
  return true;
}

bool solvable(const LoopProblem& problem) {
  const std::ptrdiff_t num_poses = std::ssize(problem.poses);
  const auto pose_ok = [](const LoopProblem::Pose& pose) { return valid(pose.T_world_camera); };
  const auto edge_ok = [num_poses](const LoopProblem::Edge& edge) { return valid(edge, num_poses); };
  return std::ranges::any_of(problem.poses, &LoopProblem::Pose::fixed) &&
         !std::ranges::all_of(problem.poses, &LoopProblem::Pose::fixed) &&
         std::ranges::all_of(problem.poses, pose_ok) && std::ranges::all_of(problem.edges, edge_ok) &&
         all_held(problem);
}

class PoseGraph {
 public:
  explicit PoseGraph(const LoopProblem& problem) : problem_(problem) {
    blocks_.reserve(problem.poses.size());
    for (const auto& pose : problem.poses) blocks_.push_back(to_block(pose.T_world_camera));
    for (const auto& edge : problem.edges) factors_.emplace_back(measured(edge));
  }

  // One round of least squares in place, `loss` on the loop edges. False when Ceres has no answer, or not in time.
  bool solve(const CloseLoopOptions& options, ceres::LossFunction& loss, double tolerance, double max_solve_s);

  Rigid3 pose(std::size_t i) const {
    return problem_.poses[i].fixed ? problem_.poses[i].T_world_camera : from_block(blocks_[i]);
  }
  int iterations() const { return iterations_; }
  double seconds() const { return seconds_; }

 private:
  const LoopProblem& problem_;
  std::vector<PoseBlock> blocks_;
  std::deque<RelativePoseFactor> factors_;  // by edge
  PoseManifold manifold_;
  int iterations_ = 0;
  double seconds_ = 0.0;
};

ceres::Problem::Options problem_options() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;  // solvable() has looked
  return options;
}

ceres::Solver::Options solver_options(const CloseLoopOptions& options, double tolerance, double max_solve_s) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;  // CHOLMOD starts threads of its own
  solver.initial_trust_region_radius = kTrustRegionRadius;
  solver.max_num_iterations = options.max_iterations;
  if (max_solve_s > 0.0) solver.max_solver_time_in_seconds = max_solve_s;
  solver.function_tolerance = tolerance;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  return solver;
}

bool PoseGraph::solve(const CloseLoopOptions& options, ceres::LossFunction& loss, double tolerance,
                      double max_solve_s) {
  ceres::Problem round(problem_options());
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    round.AddParameterBlock(blocks_[i].data(), 7, &manifold_);
    if (problem_.poses[i].fixed) round.SetParameterBlockConstant(blocks_[i].data());
  }
  for (std::size_t e = 0; e < factors_.size(); ++e) {
    const LoopProblem::Edge& edge = problem_.edges[e];
    round.AddResidualBlock(&factors_[e], edge.loop ? &loss : nullptr,
                           blocks_[static_cast<std::size_t>(edge.from)].data(),
                           blocks_[static_cast<std::size_t>(edge.to)].data());
  }
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(options, tolerance, max_solve_s), &round, &summary);
  iterations_ += summary.num_successful_steps + summary.num_unsuccessful_steps;
  seconds_ += summary.total_time_in_seconds;
  const bool late = max_solve_s > 0.0 && summary.total_time_in_seconds >= max_solve_s;
  const auto finite = [](const PoseBlock& block) {
    return Eigen::Map<const Eigen::VectorXd>(block.data(), 7).allFinite();
  };
  return summary.IsSolutionUsable() && !late && std::ranges::all_of(blocks_, finite);
}

struct Fit {
  double cost = 0.0, loop_error_m = 0.0, loop_error_rad = 0.0, strain = 0.0;
};

template <class PoseOf>
Fit fit_of(const LoopProblem& problem, ceres::LossFunction& loss, PoseOf pose) {
  Fit fit;
  for (const LoopProblem::Edge& edge : problem.edges) {
    const RelativePose relative = measured(edge);
    const Vector6d error =
        relative.error(pose(static_cast<std::size_t>(edge.from)), pose(static_cast<std::size_t>(edge.to)));
    const double square = relative.whitened(error).squaredNorm();
    double robust[3] = {square, 1.0, 0.0};
    if (edge.loop) {
      loss.Evaluate(square, robust);
      fit.loop_error_m = std::max(fit.loop_error_m, error.head<3>().norm());
      fit.loop_error_rad = std::max(fit.loop_error_rad, error.tail<3>().norm());
    } else {
      fit.strain = std::max(fit.strain, std::sqrt(square));
    }
    fit.cost += 0.5 * robust[0];
  }
  return fit;
}

}  // namespace

void close_loop(LoopProblem& problem, const CloseLoopOptions& options) {
  silence_ceres();
  problem.converged = false;
  problem.iterations = 0;
  problem.cost_before = problem.cost_after = 0.0;
  problem.loop_error_m = problem.loop_error_rad = problem.strain = 0.0;
  if (!solvable(problem)) return;
  // A right loop may begin far off: first all pull, none harder than a few sigmas; then what does not fit lets go.
  ceres::HuberLoss pull(options.loop_scale);
  ceres::CauchyLoss let_go(options.loop_scale);
  const auto before = [&problem](std::size_t i) { return problem.poses[i].T_world_camera; };
  problem.cost_before = problem.cost_after = fit_of(problem, let_go, before).cost;
  PoseGraph graph(problem);
  const double limit_s = options.max_solve_s;
  bool solved = graph.solve(options, pull, kRoughTolerance, limit_s);
  solved = solved && graph.solve(options, let_go, kFineTolerance,
                                 limit_s > 0.0 ? std::max(1e-9, limit_s - graph.seconds()) : 0.0);
  problem.iterations = graph.iterations();
  if (!solved) return;
  const Fit fit = fit_of(problem, let_go, [&graph](std::size_t i) { return graph.pose(i); });
  problem.loop_error_m = fit.loop_error_m;
  problem.loop_error_rad = fit.loop_error_rad;
  problem.strain = fit.strain;
  if (!(fit.cost <= problem.cost_before && fit.loop_error_m <= options.max_loop_error_m &&
        fit.loop_error_rad <= options.max_loop_error_rad && fit.strain <= options.max_strain)) {
    return;
  }
  problem.cost_after = fit.cost;
  for (std::size_t i = 0; i < problem.poses.size(); ++i) problem.poses[i].T_world_camera = graph.pose(i);
  problem.converged = true;
}

}  // namespace povslam
