#include "pipeline/frontend/landmark_search.hpp"

#include <algorithm>
#include <cmath>

namespace povslam {

namespace {
constexpr float kLocalRadiusPx = 4.0F;  // on the predicted level
constexpr double kMaxViewChangeCos = 0.45;
constexpr double kNearestM = 0.1;
constexpr double kRatioLast = 0.9;
}  // namespace

LandmarkSearch::LandmarkSearch(const PinholeCamera& camera, const FrontendOptions& options)
    : camera_(camera), log_scale_(std::log(options.orb.scale_factor)), num_levels_(options.orb.num_levels) {}

void LandmarkSearch::match_last(const Map& map, const Frame& last, const Frame& frame, const Rigid3& T_camera_world,
                                float radius_px, Matcher& matcher) const {
  matcher.start(frame);
  const Rigid3 T_world_last = last.T_camera_world.inverse();
  for (int i = 0; i < last.size(); ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const std::int32_t seen = last.landmark[k] != kNone && map.believed(last.landmark[k]) ? last.landmark[k] : kNone;
    if (seen == kNone && !last.has_depth(i)) continue;
    const Eigen::Vector3d p_world =
        seen != kNone ? map.landmark(seen).p_world : T_world_last * last.point_camera(i, camera_);
    const Eigen::Vector3d p = T_camera_world * p_world;
    if (p.z() < kNearestM) continue;
    const int level =
        predicted_level(last.features.level[k], (last.T_camera_world * p_world).norm(), p.norm(), log_scale_);
    MatchCandidate c;
    c.u_px = static_cast<float>(camera_.fx * p.x() / p.z() + camera_.cx);
    c.v_px = static_cast<float>(camera_.fy * p.y() / p.z() + camera_.cy);
    c.radius_px = radius_px * std::sqrt(map.level_scale(std::clamp(level, 0, num_levels_ - 1)));
    c.min_level = static_cast<std::int8_t>(level - 1);
    c.max_level = static_cast<std::int8_t>(level + 1);
    c.descriptor = &last.features.descriptor[k];
    c.tag = seen != kNone ? seen : kPointOfLast + i;
    matcher.match(frame, c, kMaxDistance, kRatioLast);
  }
}

void LandmarkSearch::match_local(Map& map, std::span<const std::int32_t> landmarks, const Frame& frame,
                                 const Rigid3& T_camera_world, float widening, Matcher& matcher) const {
  matcher.start(frame);
  match_more(map, landmarks, frame, T_camera_world, widening, matcher);
}

void LandmarkSearch::match_more(Map& map, std::span<const std::int32_t> landmarks, const Frame& frame,
                                const Rigid3& T_camera_world, float widening, Matcher& matcher) const {
  matcher.hold();
  const Eigen::Vector3d p_world_camera = T_camera_world.inverse().translation;
  const Eigen::Matrix3d R = T_camera_world.matrix3();
  for (const std::int32_t slot : landmarks) {
    if (!map.believed(slot)) continue;
    Landmark& point = map.landmark(slot);
    const Eigen::Vector3d p = R * point.p_world + T_camera_world.translation;
    if (p.z() < kNearestM) continue;
    const double u = camera_.fx * p.x() / p.z() + camera_.cx, v = camera_.fy * p.y() / p.z() + camera_.cy;
    if (!camera_.contains({u, v})) continue;
    const Eigen::Vector3d toward = p_world_camera - point.p_world;
    const double distance = toward.norm();
    if (toward.dot(point.toward_camera) < kMaxViewChangeCos * distance) continue;
    const int level = predicted_level(point.reference_level, point.reference_distance_m, distance, log_scale_);
    if (level < -1 || level > num_levels_) continue;
    ++point.visible;
    MatchCandidate c;
    c.u_px = static_cast<float>(u);
    c.v_px = static_cast<float>(v);
    c.radius_px = kLocalRadiusPx * widening * map.level_scale(std::clamp(level, 0, num_levels_ - 1));
    c.min_level = static_cast<std::int8_t>(level - 1);
    c.max_level = static_cast<std::int8_t>(level + 1);
    c.descriptor = &point.descriptor;
    c.tag = slot;
    matcher.match(frame, c, kMaxDistance, kNearestRatio);
  }
}

void LandmarkSearch::match_wide(const Map& map, std::span<const std::int32_t> landmarks, const Frame& frame,
                                const Rigid3& T_camera_world, double reach_m, Matcher& matcher) const {
  matcher.start(frame);
  for (const std::int32_t slot : landmarks) {
    const Landmark& point = map.landmark(slot);
    const Eigen::Vector3d p = T_camera_world * point.p_world;
    if (p.z() < std::max(kNearestM, 0.5 * reach_m)) continue;
    const int level = predicted_level(point.reference_level, point.reference_distance_m, p.norm(), log_scale_);
    const int levels = 1 + static_cast<int>(std::ceil(std::log1p(reach_m / p.norm()) / log_scale_));
    MatchCandidate c;
    c.u_px = static_cast<float>(camera_.fx * p.x() / p.z() + camera_.cx);
    c.v_px = static_cast<float>(camera_.fy * p.y() / p.z() + camera_.cy);
    c.radius_px = static_cast<float>(camera_.fx * reach_m / p.z());
    c.min_level = static_cast<std::int8_t>(level - levels);
    c.max_level = static_cast<std::int8_t>(level + levels);
    c.descriptor = &point.descriptor;
    c.tag = slot;
    matcher.match(frame, c, kMaxDistanceFar, kNearestRatio);
  }
}

}  // namespace povslam
