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
constexpr double kJoinedShare = 0.25;    // of what the frame finds, seen by a keyframe that serves in its stead
constexpr double kRedundantShare = 0.9;  // of a keyframe's landmarks, seen by others as well
constexpr double kSameView = 0.15;       // of the image's width: views that differ less are of one place
constexpr int kKeyframesPerView = 3;
constexpr std::int64_t kSettledKeyframes = 20;  // made since, or as long ago as so many would have taken

int shared(const Frame& frame, const Map& map, std::int32_t keyframe) {
  int count = 0;
  for (int i = 0; i < frame.size(); ++i) {
    const std::int32_t seen = frame.landmark[static_cast<std::size_t>(i)];
    if (seen == kNone) continue;
    const Landmark& point = map.landmark(seen);
    const auto sightings = std::span(point.sightings).first(static_cast<std::size_t>(point.num_sightings));
    count += std::ranges::any_of(sightings, [&](const auto& s) { return s.keyframe == keyframe; }) ? 1 : 0;
  }
  return count;
}

double mean_inverse_depth(std::span<const float> inverse_depth) {
  double sum = 0.0;
  int count = 0;
  for (const float w : inverse_depth) {
    sum += w;
    count += w > 0.0F ? 1 : 0;
  }
  return count > 0 ? sum / count : 0.0;
}
}  // namespace

Keyframer::Keyframer(const PinholeCamera& camera, const FrontendOptions& options)
    : camera_(camera), options_(options.map), triangulator_(camera, options), landmark_room_(options.orb.num_features) {
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
  if (moved_at_all && num_inliers < kKnownShare * with_depth) return !covered(frame, map, last, num_inliers);
  if (still || (age < options_.keyframe_max_frames && num_inliers >= kOverlap * most_inliers_)) return false;
  if (!covered(frame, map, last, num_inliers)) return true;
  most_inliers_ = num_inliers;  // that keyframe serves as if it were made here
  return false;
}

// Whether an earlier visit's keyframe of about this view serves as well as a new one: the frame finds what it kept, and
// not just as much, in a copy of the place that drift has put beside it.
bool Keyframer::covered(const Frame& frame, const Map& map, const Keyframe& newest, int num_inliers) const {
  const Rigid3 T_world_camera = frame.T_camera_world.inverse();
  const double inverse_depth =
      mean_inverse_depth(std::span(frame.inverse_depth).first(static_cast<std::size_t>(frame.size())));
  for (std::int32_t s = 0; s < map.keyframe_slots(); ++s) {
    const Keyframe& kf = map.keyframe(s);
    if (!kf.alive || !settled(kf, newest.id, frame.index)) continue;
    if (image_shift(camera_, kf.T_world_camera, T_world_camera, inverse_depth) < kSameView &&
        num_inliers >= kOverlap * landmarks_seen(kf) && shared(frame, map, s) >= kJoinedShare * num_inliers) {
      return true;
    }
  }
  return false;
}

// Made so long ago that it is no part of the way by which the camera came here, and its landmarks have proved
// themselves.
bool Keyframer::settled(const Keyframe& keyframe, std::int64_t newest_id, std::int64_t now_index) const {
  return newest_id - keyframe.id >= kSettledKeyframes ||
         now_index - keyframe.frame_index >= kSettledKeyframes * options_.keyframe_max_frames;
}

std::int32_t Keyframer::insert(Map& map, const FrameBuilder& images, Frame& frame, const Matrix6d& covariance,
                               std::int64_t parent_id) {
  most_inliers_ = 0;
  keyframe_room_.make(map, options_.max_keyframes);
  landmark_room_.make(map, options_.max_landmarks, frame.size());
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
  cull_landmarks(map, map.keyframe(newest).id);
  // One keyframe a time is enough: they come one at a time too.
  if (!cull_same_view(map, newest)) cull_redundant(map, newest);
}

void Keyframer::cull_landmarks(Map& map, std::int64_t now) {
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
}

// However often a place is visited, a few keyframes show it: with one too many, the one goes that would be missed
// least.
bool Keyframer::cull_same_view(Map& map, std::int32_t newest) const {
  const Keyframe& now = map.keyframe(newest);
  const double inverse_depth = mean_inverse_depth(now.inverse_depth);
  std::int32_t least = kNone;
  int count = 0, least_own = 0;
  for (std::int32_t s = 0; s < map.keyframe_slots(); ++s) {
    const Keyframe& kf = map.keyframe(s);
    if (!kf.alive || image_shift(camera_, kf.T_world_camera, now.T_world_camera, inverse_depth) >= kSameView) continue;
    ++count;
    if (kf.parent_id < 0 || !settled(kf, now.id, now.frame_index)) continue;
    const int own = use_of(map, s).own;
    if (least != kNone && own >= least_own) continue;
    least = s;
    least_own = own;
  }
  if (count <= kKeyframesPerView || least == kNone) return false;
  map.remove_keyframe(least);
  return true;
}

bool Keyframer::cull_redundant(Map& map, std::int32_t newest) const {
  const Keyframe& now = map.keyframe(newest);
  for (int c = 0; c < now.num_covisible; ++c) {
    const std::int32_t slot = now.covisible[static_cast<std::size_t>(c)].keyframe;
    if (map.keyframe(slot).parent_id < 0 || now.id - map.keyframe(slot).id < kProbationKeyframes) continue;
    const KeyframeUse use = use_of(map, slot);
    if (use.seen == 0 || use.own >= (1.0 - kRedundantShare) * use.seen) continue;
    map.remove_keyframe(slot);
    return true;
  }
  return false;
}

}  // namespace povslam
