#include "pipeline/frontend/keyframer.hpp"

#include <algorithm>

namespace povslam {

namespace {
constexpr double kOverlap = 0.75;    // of the landmarks seen right after the last keyframe
constexpr double kKnownShare = 0.4;  // of the features with depth: fewer known ones, and the map lacks this view
constexpr double kMinMoveM = 0.05;   // a camera that stands still makes no keyframes
constexpr double kMinTurnRad = 0.05;
constexpr std::int64_t kProbationKeyframes = 3;
constexpr double kMinFoundRatio = 0.25;
constexpr double kRedundantShare = 0.9;  // of a keyframe's landmarks…
constexpr int kRedundantSightings = 3;   // …seen by this many others at least as closely
}  // namespace

Keyframer::Keyframer(const PinholeCamera& camera, const FrontendOptions& options)
    : camera_(camera), options_(options.map), triangulator_(camera, options) {
  recent_.reserve(static_cast<std::size_t>(options.orb.num_features) * 16);
}

bool Keyframer::wanted(const Frame& frame, const Map& map, std::int32_t newest, int num_inliers, bool weak) {
  const Keyframe& last = map.keyframe(newest);
  most_inliers_ = std::max(most_inliers_, num_inliers);
  const std::int64_t age = frame.index - last.frame_index;
  const Rigid3 moved = frame.T_camera_world * last.T_world_camera;
  const bool still = moved.translation.norm() < kMinMoveM && rotation_angle_rad(moved) < kMinTurnRad;
  if (weak) return age >= 1 && !still;
  if (age < options_.keyframe_min_frames) return false;
  int with_depth = 0;
  for (int i = 0; i < frame.size(); ++i) with_depth += frame.has_depth(i) ? 1 : 0;
  const bool moved_at_all = moved.translation.norm() > 0.2 * kMinMoveM || rotation_angle_rad(moved) > 0.2 * kMinTurnRad;
  if (moved_at_all && num_inliers < kKnownShare * with_depth) return true;
  if (still) return false;
  return age >= options_.keyframe_max_frames || num_inliers < kOverlap * most_inliers_;
}

std::int32_t Keyframer::insert(Map& map, const FrameBuilder& images, Frame& frame, const Matrix6d& covariance,
                               std::int64_t parent_id) {
  most_inliers_ = 0;
  const std::int32_t slot = map.insert_keyframe(frame, frame.T_camera_world.inverse(), covariance, parent_id);
  for (int i = 0; i < frame.size(); ++i) {
    std::int32_t& seen = frame.landmark[static_cast<std::size_t>(i)];
    if (seen != kNone && !map.landmark(seen).alive) seen = kNone;  // gone with the keyframe that made room
    if (seen == kNone) continue;
    if (map.add_sighting(seen, slot, i)) map.refresh_landmark(seen);
  }
  create_landmarks(map, images, frame, slot);
  map.update_covisibility(slot);
  triangulate_landmarks(map, images, frame, slot);
  return slot;
}

void Keyframer::create_landmarks(Map& map, const FrameBuilder& images, Frame& frame, std::int32_t slot) {
  const Rigid3 T_world_camera = map.keyframe(slot).T_world_camera;
  for (int i = 0; i < frame.size(); ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    if (map.keyframe(slot).landmark[k] != kNone || !frame.has_depth(i)) continue;
    const std::int32_t made = map.create_landmark(slot, i, T_world_camera * frame.point_camera(i, camera_));
    if (made == kNone) return;
    frame.landmark[k] = made;
    keep_look(map, images, frame, i, made);
    put_on_probation(map, made);
  }
}

void Keyframer::triangulate_landmarks(Map& map, const FrameBuilder& images, Frame& frame, std::int32_t slot) {
  for (const Triangulator::Made& made : triangulator_.create(map, slot)) {
    frame.landmark[static_cast<std::size_t>(made.feature)] = made.landmark;
    keep_look(map, images, frame, made.feature, made.landmark);
    put_on_probation(map, made.landmark);
  }
}

void Keyframer::put_on_probation(const Map& map, std::int32_t landmark) {
  if (recent_.size() < recent_.capacity()) recent_.push_back({landmark, map.landmark(landmark).generation});
}

// The patch of the image around the feature, and the piece of surface that one pixel of it covers.
void Keyframer::keep_look(Map& map, const FrameBuilder& images, const Frame& frame, int feature,
                          std::int32_t slot) const {
  const std::size_t k = static_cast<std::size_t>(feature);
  const PyramidLevel& level = images.level(frame.features.level[k]);
  const float x = (frame.features.x[k] + 0.5F) / level.scale - 0.5F,
              y = (frame.features.y[k] + 0.5F) / level.scale - 0.5F;
  Landmark& point = map.landmark(slot);
  point.has_patch = cut_patch(level, x, y, map.patch(slot));
  if (!point.has_patch) return;
  const double inverse = 1.0 / (frame.T_camera_world * point.p_world).z();
  const Eigen::Vector3d ray((frame.x[k] - camera_.cx) / camera_.fx, (frame.y[k] - camera_.cy) / camera_.fy, 1.0);
  const Eigen::Vector3d dx(level.scale / camera_.fx, 0.0, 0.0), dy(0.0, level.scale / camera_.fy, 0.0);
  const Eigen::Quaterniond R_world_camera = frame.T_camera_world.rotation.conjugate();
  // d(ray / w) along a pixel step: (d ray - ray * dw / w) / w.
  const auto tangent = [&](const Eigen::Vector3d& d_ray, float slope) {
    const double dw = static_cast<double>(slope) * level.scale;
    return Eigen::Vector3f((R_world_camera * ((d_ray - ray * dw / inverse) / inverse)).cast<float>());
  };
  point.tangent_x = tangent(dx, frame.slope_x[k]);
  point.tangent_y = tangent(dy, frame.slope_y[k]);
}

void Keyframer::cull(Map& map, std::int32_t newest) {
  const std::int64_t now = map.keyframe(newest).id;
  std::size_t kept = 0;
  for (const Recent& r : recent_) {
    const Landmark& point = map.landmark(r.slot);
    if (!point.alive || point.generation != r.generation) continue;
    const std::int64_t age = now - point.born_keyframe;
    const bool unseen = point.found < kMinFoundRatio * point.visible;
    const bool alone = age >= kProbationKeyframes && point.num_sightings < 2;
    if (unseen || alone) {
      map.remove_landmark(r.slot);
    } else if (age < kProbationKeyframes) {
      recent_[kept++] = r;
    }
  }
  recent_.resize(kept);
  // One redundant keyframe a time is enough: they come one at a time too.
  const Keyframe& kf = map.keyframe(newest);
  for (int c = 0; c < kf.num_covisible; ++c) {
    const std::int32_t slot = kf.covisible[static_cast<std::size_t>(c)].keyframe;
    if (map.keyframe(slot).parent_id < 0 || now - map.keyframe(slot).id < 3 || !redundant(map, slot)) continue;
    map.remove_keyframe(slot);
    return;
  }
}

bool Keyframer::redundant(const Map& map, std::int32_t slot) const {
  const Keyframe& kf = map.keyframe(slot);
  int seen = 0, well_seen_by_others = 0;
  for (std::size_t f = 0; f < kf.landmark.size(); ++f) {
    if (kf.landmark[f] == kNone) continue;
    const Landmark& point = map.landmark(kf.landmark[f]);
    ++seen;
    int others = 0;
    for (int s = 0; s < point.num_sightings && others < kRedundantSightings; ++s) {
      const LandmarkSighting& sighting = point.sightings[static_cast<std::size_t>(s)];
      if (sighting.keyframe == slot) continue;
      if (map.keyframe(sighting.keyframe).level[static_cast<std::size_t>(sighting.feature)] <= kf.level[f] + 1)
        ++others;
    }
    if (others >= kRedundantSightings) ++well_seen_by_others;
  }
  return seen > 0 && well_seen_by_others > kRedundantShare * seen;
}

}  // namespace povslam
