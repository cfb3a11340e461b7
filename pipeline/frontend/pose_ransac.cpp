#include "pipeline/frontend/pose_ransac.hpp"

#include <array>
#include <cmath>

#include "pipeline/base/expects.hpp"
#include "pipeline/geometry/align.hpp"

namespace povslam {

namespace {
constexpr int kMaxDraws = 3000;  // of three points; most are refused at once, since their distances do not agree
constexpr int kMaxPoses = 200;   // that are judged by all points
constexpr double kMinSideM = 0.15;
constexpr double kWidePx = 10.0, kNarrowPx = 3.0;       // standard deviations of a pixel…
constexpr double kWideDepth = 5.0, kNarrowDepth = 4.0;  // …and of a depth
constexpr double kNearestM = 0.1;
}  // namespace

struct PoseRansac::Random {
  std::uint32_t state = 1;
  std::uint32_t below(std::size_t n) {
    state = state * 1664525U + 1013904223U;
    return static_cast<std::uint32_t>((static_cast<std::uint64_t>(state) * n) >> 32);
  }
};

PoseRansac::PoseRansac(const PinholeCamera& camera, std::size_t max_points) : camera_(camera) {
  with_depth_.reserve(max_points);
  agreeing_.reserve(max_points);
}

bool PoseRansac::agrees(const PinholeCamera& camera, const PoseObservation& point, const Eigen::Vector3d& p,
                        bool wide) {
  if (!(p.z() > kNearestM)) return false;
  const double du = camera.fx * p.x() / p.z() + camera.cx - point.u_px;
  const double dv = camera.fy * p.y() / p.z() + camera.cy - point.v_px;
  const double limit_px = wide ? kWidePx : kNarrowPx, limit_depth = wide ? kWideDepth : kNarrowDepth;
  if (!((du * du + dv * dv) * point.weight_px < limit_px * limit_px)) return false;
  const double dd = 1.0 / p.z() - point.inverse_depth_per_m;
  return !(dd * dd * point.weight_inverse_depth > limit_depth * limit_depth);
}

std::optional<Rigid3> PoseRansac::find(std::span<const PoseObservation> points, int min_agreeing) {
  EXPECTS(points.size() <= agreeing_.capacity());
  with_depth_.clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].weight_inverse_depth > 0.0) with_depth_.push_back(static_cast<std::uint32_t>(i));
  }
  if (with_depth_.size() < 3) return std::nullopt;
  Random random;
  std::optional<Rigid3> best;
  int most_wide = min_agreeing - 1, most = min_agreeing - 1, poses = 0;
  for (int draw = 0; draw < kMaxDraws && poses < kMaxPoses; ++draw) {
    const auto rough = pose_of_three(points, random);
    if (!rough) continue;
    ++poses;
    const int agreeing = count(points, *rough, true);
    if (agreeing <= most_wide) continue;
    most_wide = agreeing;
    const Rigid3 polished = polish(points, *rough);
    const int close = count(points, polished, false);
    if (close <= most) continue;
    most = close;
    best = polished;
    // Half of the points: the next ones will hardly say otherwise.
    if (2 * close > static_cast<int>(points.size())) break;
  }
  return best;
}

std::optional<Rigid3> PoseRansac::pose_of_three(std::span<const PoseObservation> points, Random& random) const {
  std::array<Eigen::Vector3d, 3> in_camera, in_world;
  std::array<double, 3> sigma_m{};
  for (std::size_t k = 0; k < 3; ++k) {
    const PoseObservation& point = points[with_depth_[random.below(with_depth_.size())]];
    const double z = 1.0 / point.inverse_depth_per_m;
    in_camera[k] = {(point.u_px - camera_.cx) / camera_.fx * z, (point.v_px - camera_.cy) / camera_.fy * z, z};
    in_world[k] = point.p_world;
    sigma_m[k] = z * z / std::sqrt(point.weight_inverse_depth);
    for (std::size_t j = 0; j < k; ++j) {
      const double here = (in_camera[k] - in_camera[j]).norm(), there = (in_world[k] - in_world[j]).norm();
      if (!(std::min(here, there) > kMinSideM)) return std::nullopt;
      if (std::abs(here - there) > 0.03 + 3.0 * std::hypot(sigma_m[j], sigma_m[k])) return std::nullopt;
    }
  }
  // On one line, the turn about it is anyone's guess.
  const Eigen::Vector3d side = in_world[1] - in_world[0], other = in_world[2] - in_world[0];
  if (side.cross(other).norm() < 0.1 * side.norm() * other.norm()) return std::nullopt;
  return align_points(in_camera, in_world);
}

int PoseRansac::count(std::span<const PoseObservation> points, const Rigid3& T_camera_world, bool wide) const {
  const Eigen::Matrix3d R = T_camera_world.matrix3();
  int agreeing = 0;
  for (const PoseObservation& point : points) {
    agreeing += agrees(camera_, point, R * point.p_world + T_camera_world.translation, wide) ? 1 : 0;
  }
  return agreeing;
}

Rigid3 PoseRansac::polish(std::span<const PoseObservation> points, const Rigid3& T_camera_world) {
  agreeing_.clear();
  for (const PoseObservation& point : points) {
    if (agrees(camera_, point, T_camera_world * point.p_world, true)) agreeing_.push_back(point);
  }
  PoseSolverOptions options;
  options.rounds = 3;
  options.iterations = 4;
  options.first_gate = 9.0;
  const PoseSolution solution = solve_pose(camera_, T_camera_world, agreeing_, options);
  return solution.converged ? solution.T_camera_world : T_camera_world;
}

}  // namespace povslam
