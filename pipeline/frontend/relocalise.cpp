#include "pipeline/frontend/relocalise.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/frontend/match.hpp"
#include "pipeline/geometry/align.hpp"

namespace povslam {

namespace {
constexpr int kMinPairs = 15;
constexpr int kTriples = 150;
constexpr double kInlierPx = 4.0;  // at level 0, while judging triples
constexpr double kUniqueRatio = 0.8;

// Small deterministic generator: the same frame and map give the same answer.
struct Lcg {
  std::uint32_t state;
  std::uint32_t below(std::uint32_t n) {
    state = state * 1664525U + 1013904223U;
    return static_cast<std::uint32_t>((static_cast<std::uint64_t>(state) * n) >> 32);
  }
};
}  // namespace

Relocaliser::Relocaliser(const PinholeCamera& camera, const FrontendOptions& options) : camera_(camera) {
  const std::size_t n = static_cast<std::size_t>(options.orb.num_features);
  pairs_.reserve(n);
  pair_of_feature_.resize(n);
  distance_of_feature_.resize(n);
  observations_.reserve(n);
}

void Relocaliser::collect_pairs(const Map& map, std::int32_t slot, const Frame& frame) {
  pairs_.clear();
  std::fill_n(pair_of_feature_.begin(), frame.size(), kNone);
  std::fill_n(distance_of_feature_.begin(), frame.size(), 257);
  for (const std::int32_t seen : map.keyframe(slot).landmark) {
    if (seen == kNone) continue;
    const Landmark& point = map.landmark(seen);
    const NearestDescriptor nearest =
        nearest_descriptor(point.descriptor, frame.features.descriptor.data(), frame.size());
    if (nearest.index < 0 || nearest.distance > kMaxDistanceFar) continue;
    if (nearest.distance > kUniqueRatio * nearest.second_distance) continue;
    const std::size_t f = static_cast<std::size_t>(nearest.index);
    if (nearest.distance >= distance_of_feature_[f]) continue;
    distance_of_feature_[f] = nearest.distance;
    Pair pair{nearest.index, Eigen::Vector3d::Zero(), point.p_world, frame.has_depth(nearest.index)};
    if (pair.has_depth) pair.p_camera = frame.point_camera(nearest.index, camera_);
    if (pair_of_feature_[f] != kNone) {
      pairs_[static_cast<std::size_t>(pair_of_feature_[f])] = pair;
    } else if (pairs_.size() < pairs_.capacity()) {
      pair_of_feature_[f] = static_cast<std::int32_t>(pairs_.size());
      pairs_.push_back(pair);
    }
  }
}

int Relocaliser::count_inliers(const Frame& frame, const Rigid3& T) const {
  int count = 0;
  const Eigen::Matrix3d R = T.matrix3();
  for (const Pair& pair : pairs_) {
    const Eigen::Vector3d p = R * pair.p_world + T.translation;
    if (p.z() < 0.1) continue;
    const std::size_t f = static_cast<std::size_t>(pair.feature);
    const double du = camera_.fx * p.x() / p.z() + camera_.cx - frame.x[f];
    const double dv = camera_.fy * p.y() / p.z() + camera_.cy - frame.y[f];
    const double limit = kInlierPx * std::sqrt(1.0 + frame.features.level[f]);
    if (du * du + dv * dv > limit * limit) continue;
    if (pair.has_depth && std::abs(1.0 / p.z() - frame.inverse_depth[f]) > 6.0 * frame.sigma_inverse_depth[f] + 0.01)
      continue;
    ++count;
  }
  return count;
}

std::optional<Rigid3> Relocaliser::best_of_triples(const Frame& frame) const {
  Lcg random{static_cast<std::uint32_t>(frame.index) * 2654435761U + 1U};
  std::optional<Rigid3> best;
  int best_count = kMinPairs - 1;
  const std::uint32_t n = static_cast<std::uint32_t>(pairs_.size());
  for (int trial = 0; trial < kTriples; ++trial) {
    std::array<Eigen::Vector3d, 3> camera_points, world_points;
    int have = 0;
    for (int draw = 0; draw < 12 && have < 3; ++draw) {
      const Pair& pair = pairs_[random.below(n)];
      if (!pair.has_depth) continue;
      bool distinct = true;
      for (int j = 0; j < have; ++j) {
        distinct = distinct && (world_points[static_cast<std::size_t>(j)] - pair.p_world).norm() > 0.05;
      }
      if (!distinct) continue;
      camera_points[static_cast<std::size_t>(have)] = pair.p_camera;
      world_points[static_cast<std::size_t>(have++)] = pair.p_world;
    }
    if (have < 3) continue;
    const auto T = align_points(camera_points, world_points);
    if (!T) continue;
    const int count = count_inliers(frame, *T);
    if (count > best_count) best_count = count, best = T;
  }
  return best;
}

std::optional<Relocaliser::Found> Relocaliser::against(const Map& map, std::int32_t slot, const Frame& frame) {
  collect_pairs(map, slot, frame);
  if (pairs_.size() < static_cast<std::size_t>(kMinPairs)) return std::nullopt;
  const auto start = best_of_triples(frame);
  if (!start) return std::nullopt;
  observations_.clear();
  for (const Pair& pair : pairs_) {
    const std::size_t f = static_cast<std::size_t>(pair.feature);
    PoseObservation o;
    o.p_world = pair.p_world;
    o.u_px = frame.x[f], o.v_px = frame.y[f];
    o.weight_px = 1.0 / (static_cast<double>(frame.sigma_px[f]) * frame.sigma_px[f]);
    if (pair.has_depth) {
      o.inverse_depth_per_m = frame.inverse_depth[f];
      o.weight_inverse_depth = 0.5 / (frame.sigma_inverse_depth[f] * frame.sigma_inverse_depth[f]);
    }
    observations_.push_back(o);
  }
  PoseSolverOptions options;
  options.first_gate = 9.0;
  const PoseSolution solution = solve_pose(camera_, *start, observations_, options);
  if (!solution.converged || solution.num_inliers < kMinPairs) return std::nullopt;
  return Found{solution.T_camera_world, solution.num_inliers};
}

}  // namespace povslam
