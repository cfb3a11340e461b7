#include "pipeline/backend/smooth_window.hpp"

#include <ceres/loss_function.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace povslam {

namespace {

constexpr double kMaxUnitError = 1e-3;         // of a quaternion's norm
constexpr double kMinScaledEigenvalue = 1e-7;  // of a pose's 6x6 information scaled to a unit diagonal
constexpr int kMinResidualsPerPoint = 3;       // as many as unknowns
constexpr double kMaxMoveOverRange = 3.0;      // a point that moved farther, in units of its range, is not believed

KeypointObservation pixel_of(const SmoothProblem& problem, const SmoothProblem::Observation& seen) {
  return {.fx = problem.fx,
          .fy = problem.fy,
          .cx = problem.cx,
          .cy = problem.cy,
          .u_px = seen.u_px,
          .v_px = seen.v_px,
          .sigma_px = seen.sigma_px};
}

bool valid(const SmoothProblem::Pose& pose) {
  const Rigid3& T = pose.T_world_camera;
  return T.translation.allFinite() && std::abs(T.rotation.norm() - 1.0) < kMaxUnitError;
}

bool valid(const SmoothProblem::Observation& seen, const SmoothProblem& problem) {
  return seen.pose >= 0 && seen.pose < std::ssize(problem.poses) && seen.point >= 0 &&
         seen.point < std::ssize(problem.points) && std::isfinite(seen.u_px) && std::isfinite(seen.v_px) &&
         std::isfinite(seen.inverse_depth_per_m) && std::isfinite(seen.sigma_px) && seen.sigma_px > 0.0F &&
         std::isfinite(seen.sigma_inverse_depth_per_m) && seen.sigma_inverse_depth_per_m > 0.0F;
}

bool well_conditioned(const Matrix6d& information) {
  const Vector6d diagonal = information.diagonal();
  if (!(diagonal.minCoeff() > 0.0)) return false;
  const Vector6d scale = diagonal.cwiseSqrt().cwiseInverse();
  const Matrix6d scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scaled, Eigen::EigenvaluesOnly);
  return eigen.info() == Eigen::Success && eigen.eigenvalues().minCoeff() > kMinScaledEigenvalue;
}

}  // namespace

bool valid(const SmoothProblem& problem) {
  const auto pose_ok = [](const auto& pose) { return valid(pose); };
  const auto point_ok = [](const auto& point) { return point.p_world.allFinite(); };
  const auto observation_ok = [&problem](const auto& seen) { return valid(seen, problem); };
  return problem.fx > 0.0 && problem.fy > 0.0 && std::isfinite(problem.fx + problem.fy + problem.cx + problem.cy) &&
         std::ranges::any_of(problem.poses, &SmoothProblem::Pose::fixed) &&
         std::ranges::all_of(problem.poses, pose_ok) && std::ranges::all_of(problem.points, point_ok) &&
         std::ranges::all_of(problem.observations, observation_ok);
}

SmoothWindow::SmoothWindow(const SmoothProblem& problem)
    : used(problem.observations.size(), 1), depth_used(problem.observations.size(), 0), problem_(problem) {
  poses.reserve(problem.poses.size());
  points.reserve(problem.points.size());
  for (const auto& pose : problem.poses) poses.push_back(to_block(pose.T_world_camera));
  for (const auto& point : problem.points) points.push_back(point.p_world);
  for (std::size_t i = 0; i < used.size(); ++i) {
    const auto& seen = problem.observations[i];
    pixels.emplace_back(pixel_of(problem, seen));
    depths.emplace_back(seen.inverse_depth_per_m, seen.sigma_inverse_depth_per_m);
    depth_used[i] = seen.inverse_depth_per_m > 0.0F;
  }
}

void SmoothWindow::leave_out_undetermined() {
  const std::vector<char> determined = determined_poses();
  std::vector<int> residuals(points.size(), 0);
  for (std::size_t i = 0; i < used.size(); ++i) {
    const auto& seen = problem_.observations[i];
    used[i] = used[i] != 0 && determined[seen.pose] != 0;
    if (used[i] != 0) residuals[seen.point] += depth_used[i] != 0 ? 3 : 2;
  }
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (residuals[problem_.observations[i].point] < kMinResidualsPerPoint) used[i] = 0;
  }
}

// Fixed poses are; a free one is when the points it sees, taken as known, hold all of its six directions.
std::vector<char> SmoothWindow::determined_poses() const {
  std::vector<Matrix6d> information(poses.size(), Matrix6d::Zero());
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> by_point;  // of the pixel's two residuals and the depth's
  Eigen::Vector3d residual;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const auto& seen = problem_.observations[i];
    if (used[i] == 0 || problem_.poses[seen.pose].fixed) continue;
    const double* blocks[] = {poses[seen.pose].data(), points[seen.point].data()};
    double* by_pixel[] = {nullptr, by_point.data()};
    double* by_depth[] = {nullptr, by_point.data() + 6};
    by_point.setZero();
    pixels[i].Evaluate(blocks, residual.data(), by_pixel);
    if (depth_used[i] != 0) depths[i].Evaluate(blocks, residual.data(), by_depth);
    const Eigen::Map<const Eigen::Vector3d> p_world(poses[seen.pose].data() + 4);
    Eigen::Matrix<double, 3, 6> by_pose;  // about retract's xi: d p_camera = R^T (dp - rho + [p - t]x phi)
    by_pose << -by_point, by_point * skew(points[seen.point] - p_world);
    information[seen.pose].noalias() += by_pose.transpose() * by_pose;
  }
  std::vector<char> determined(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    determined[i] = problem_.poses[i].fixed || well_conditioned(information[i]);
  }
  return determined;
}

void SmoothWindow::leave_out_outliers(const SmoothOptions& options) {
  for (std::size_t i = 0; i < used.size(); ++i) {
    used[i] = pixel_fits(i, options);
    depth_used[i] = depth_fits(i, options);
  }
}

void SmoothWindow::restore_unbelievable_points() {
  std::vector<double> reach(points.size(), 0.0);  // how far the point may have moved
  for (std::size_t i = 0; i < used.size(); ++i) {
    const auto& seen = problem_.observations[i];
    if (used[i] == 0) continue;
    const Rigid3 T_world_camera = from_block(poses[seen.pose]);
    const Eigen::Vector3d& before_world = problem_.points[seen.point].p_world;
    const bool in_front = (T_world_camera.inverse() * points[seen.point]).z() > KeypointFactor::kMinDepthM;
    const double range = (before_world - T_world_camera.translation).norm();
    if (in_front) reach[seen.point] = std::max(reach[seen.point], kMaxMoveOverRange * range);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d& before_world = problem_.points[i].p_world;
    if (!((points[i] - before_world).norm() <= reach[i])) points[i] = before_world;
  }
}

double SmoothWindow::chi2_pixel(std::size_t observation) const {
  const auto& seen = problem_.observations[observation];
  const double* blocks[] = {poses[seen.pose].data(), points[seen.point].data()};
  Eigen::Vector2d residual;
  pixels[observation].Evaluate(blocks, residual.data(), nullptr);
  return residual.squaredNorm();
}

double SmoothWindow::chi2_depth(std::size_t observation) const {
  const auto& seen = problem_.observations[observation];
  const double* blocks[] = {poses[seen.pose].data(), points[seen.point].data()};
  double residual = 0.0;
  depths[observation].Evaluate(blocks, &residual, nullptr);
  return residual * residual;
}

bool SmoothWindow::pixel_fits(std::size_t observation, const SmoothOptions& options) const {
  return chi2_pixel(observation) <= options.outlier_chi2_pixel;
}

bool SmoothWindow::depth_fits(std::size_t observation, const SmoothOptions& options) const {
  return problem_.observations[observation].inverse_depth_per_m > 0.0F &&
         chi2_depth(observation) <= options.outlier_chi2_depth;
}

double SmoothWindow::robust_cost(const SmoothOptions& options) const {
  const ceres::HuberLoss pixel_loss(options.huber_pixel), depth_loss(options.huber_depth);
  double cost = 0.0, rho[3];
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    pixel_loss.Evaluate(chi2_pixel(i), rho);
    cost += 0.5 * rho[0];
    if (!(problem_.observations[i].inverse_depth_per_m > 0.0F)) continue;
    depth_loss.Evaluate(chi2_depth(i), rho);
    cost += 0.5 * rho[0];
  }
  return cost;
}

bool SmoothWindow::finite() const {
  const auto ok = [](double value) { return std::isfinite(value); };
  return std::ranges::all_of(poses, [&ok](const PoseBlock& pose) { return std::ranges::all_of(pose, ok); });
}

}  // namespace povslam
