#include "pipeline/frontend/fuse.hpp"

#include <cmath>

#include "pipeline/frontend/match.hpp"

namespace povslam {

namespace {
constexpr float kRadiusPx = 6.0F;  // on the predicted level
constexpr double kMaxViewChangeCos = 0.45;
constexpr double kNearestM = 0.1;
constexpr double kDepthSigmas = 6.0;
constexpr double kDepthSlack = 0.02;     // 1/m: what the correction leaves between the visits
constexpr double kMaxApartM = 0.10;      // of two landmarks that become one…
constexpr double kMaxApartShare = 0.03;  // …or of their distance
}  // namespace

LandmarkFuser::LandmarkFuser(const PinholeCamera& camera, const FrontendOptions& options)
    : camera_(camera),
      log_scale_(std::log(options.orb.scale_factor)),
      grid_(options.orb.num_features, 0.0F, 0.0F, static_cast<float>(camera.width), static_cast<float>(camera.height)) {
}

int LandmarkFuser::find_feature(const Map& map, const Keyframe& kf, const Landmark& point) const {
  const Eigen::Vector3d p = kf.T_world_camera.inverse() * point.p_world;
  if (p.z() < kNearestM) return -1;
  const double u = camera_.fx * p.x() / p.z() + camera_.cx, v = camera_.fy * p.y() / p.z() + camera_.cy;
  if (!camera_.contains({u, v})) return -1;
  const Eigen::Vector3d toward = kf.T_world_camera.translation - point.p_world;
  if (toward.dot(point.toward_camera) < kMaxViewChangeCos * toward.norm()) return -1;
  const int level = predicted_level(point.reference_level, point.reference_distance_m, toward.norm(), log_scale_);
  if (level < -1 || level > map.num_levels()) return -1;
  const float radius = kRadiusPx * map.level_scale(std::clamp(level, 0, map.num_levels() - 1));
  int best = -1, best_distance = kMaxDistanceFar + 1;
  grid_.for_each_near(static_cast<float>(u), static_cast<float>(v), radius, [&](std::int32_t i) {
    const std::size_t f = static_cast<std::size_t>(i);
    if (std::abs(kf.level[f] - level) > 1) return;
    if (std::hypot(static_cast<double>(kf.x[f]) - u, static_cast<double>(kf.y[f]) - v) > radius) return;
    if (kf.inverse_depth[f] > 0.0F) {
      const double off = std::abs(1.0 / p.z() - static_cast<double>(kf.inverse_depth[f]));
      if (off > kDepthSigmas * static_cast<double>(kf.sigma_inverse_depth[f]) + kDepthSlack) return;
    }
    const int distance = hamming_distance(point.descriptor, kf.descriptor[f]);
    if (distance < best_distance) best = i, best_distance = distance;
  });
  return best;
}

int LandmarkFuser::fuse(Map& map, std::int32_t slot, std::span<const std::int32_t> landmarks) {
  const Keyframe& kf = map.keyframe(slot);
  grid_.build(kf.x, kf.y);
  int gained = 0;
  for (const std::int32_t candidate : landmarks) {
    const Landmark& point = map.landmark(candidate);
    if (!point.alive || map.sees(slot, candidate)) continue;
    const int feature = find_feature(map, kf, point);
    if (feature < 0) continue;
    const std::int32_t had = kf.landmark[static_cast<std::size_t>(feature)];
    if (had != kNone) {
      const double distance = (kf.T_world_camera.translation - point.p_world).norm();
      const double apart = (map.landmark(had).p_world - point.p_world).norm();
      if (apart > kMaxApartM + kMaxApartShare * distance) continue;
      map.merge_landmarks(candidate, had);
    } else {
      map.add_sighting(candidate, slot, feature);
      map.refresh_landmark(candidate);
    }
    ++gained;
  }
  if (gained > 0) map.update_covisibility(slot);
  return gained;
}

}  // namespace povslam
