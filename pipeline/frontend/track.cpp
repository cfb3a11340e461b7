#include "pipeline/frontend/track.hpp"

#include <algorithm>

namespace povslam {

namespace {
constexpr double kMinAgreement = 0.5;    // of thumbnails before the turn they tell is believed
constexpr double kUnseenSpeedMps = 1.0;  // how fast the pose may leave us while nothing is seen
constexpr double kUnseenTurnRadps = 1.0;
}  // namespace

Tracker::Tracker(const SensorCalibration& calibration, const FrontendOptions& options,
                 const Rigid3& T_world_camera_start, const MapContent* content)
    : camera_(calibration.camera),
      rolling_shutter_s_(calibration.rolling_shutter_s),
      options_(options),
      T_world_camera_start_(T_world_camera_start),
      builder_(camera_, options),
      map_(options.orb.num_features, options.map, builder_.level_scales()),
      local_map_(options.map),
      search_(camera_, options),
      matcher_(options.orb.num_features),
      turn_prior_(camera_),
      refiner_(camera_, options),
      depth_noise_(static_cast<std::size_t>(options.orb.num_features)),
      keyframer_(camera_, options),
      relocaliser_(camera_, options),
      smooth_exchange_(camera_, options),
      journal_(camera_, options.map),
      places_(options.orb.num_features, options.map),
      loops_(camera_, options),
      wishes_(camera_, options.track.object_landmarks),
      frame_(camera_, options),
      last_(camera_, options) {
  observations_.reserve(static_cast<std::size_t>(options.orb.num_features));
  observed_feature_.reserve(static_cast<std::size_t>(options.orb.num_features));
  smooth_exchange_.reserve(problem_);
  result_.T_world_camera = T_world_camera_start;
  if (content != nullptr && !content->keyframes.empty()) adopt(*content);
}

const TrackResult& Tracker::track(const RgbdFrame& input) {
  const TimeNs start = thread_cpu_now();
  result_.keyframe = false;
  apply_answers();
  std::swap(frame_, last_);
  builder_.build(input, depth_noise_.value(), frame_, wishes_.after(map_, local_map_, last_));
  frame_.index = frame_index_++;
  turn_prior_.look(builder_.images());
  refiner_.start(frame_);
  result_.num_features = frame_.size();
  const TimeNs built = thread_cpu_now();
  TimeNs posed = built;
  if (result_.state == TrackState::initialising) {
    if (start_map()) name_reference();
  } else {
    const bool tracked = track_frame();
    if (tracked && rolling_shutter_s_ != 0.0 && map_.next_keyframe_id() == 1 &&
        frame_.index == map_.keyframe(newest_keyframe_).frame_index + 1) {
      restart_map();
    }
    posed = thread_cpu_now();
    update_state(tracked);
    if (tracked) upkeep();
    if (map_is_worthless(tracked)) begin_again();
  }
  result_.features_ns = built - start;
  result_.track_ns = posed - built;
  result_.keyframe_ns = thread_cpu_now() - posed;
  return result_;
}

bool Tracker::track_frame() {
  const TrackResult held = result_;
  const bool may_follow = result_.state != TrackState::lost;
  if (may_follow && track_from_last() && track_local_map(frame_.T_camera_world, 1.0F) && moved_possibly()) {
    // After a held pose a few landmarks that fit are chance.
    if (bad_frames_ == 0 || result_.num_landmarks >= kMinToRelocalise) return true;
  }
  result_ = held;
  if (!relocalise()) return false;
  // No motion led here from the last pose, and trust begins anew.
  if (result_.state == TrackState::lost) ++result_.map_version;
  bad_frames_ = std::max(bad_frames_, 1);
  good_frames_ = 0;
  result_.state = TrackState::degraded;
  return true;
}

// A start is good when most of what the last frame saw is found again where it says; else others are tried.
bool Tracker::track_from_last() {
  const float radius = static_cast<float>(options_.track.search_radius_px);
  const int strong = std::max(kMinFromLast, matches_of_last_ / 2);
  const Rigid3 predicted = motion_.predict(frame_.stamp - last_.stamp).inverse() * last_.T_camera_world;
  const auto good = [this](int found, int wanted) {
    if (found >= wanted) matches_of_last_ = found;
    return found >= wanted;
  };
  const int first = match_last(predicted, radius);
  if (good(first, strong)) return true;
  const TurnPrior::Turn turn =
      turn_prior_.estimate((predicted.rotation * last_.T_camera_world.rotation.conjugate()).normalized());
  if (turn.agreement > kMinAgreement) {
    const Rigid3 turned = Rigid3{turn.R_now_before, Eigen::Vector3d::Zero()} * last_.T_camera_world;
    if (good(match_last(turned, radius), strong)) return true;
    if (good(match_last(turned, 2.0F * radius), std::max(first, kMinFromLast))) return true;
  }
  return good(match_last(predicted, 2.0F * radius), kMinFromLast) ||
         good(match_last(last_.T_camera_world, 4.0F * radius), kMinFromLast);
}

void Tracker::hold_pose() {
  frame_.T_camera_world = result_.T_world_camera.inverse();
  std::fill_n(frame_.landmark.begin(), frame_.size(), kNone);
  std::fill_n(frame_.misfit.begin(), frame_.size(), kNone);
  motion_.forget();
  matches_of_last_ = 0;
  result_.num_landmarks = 0;
  // The error grows with the time unseen, not with its root: a moving robot keeps its direction.
  const double before_s = unseen_s_;
  unseen_s_ += std::max(0.0, to_seconds(frame_.stamp - last_.stamp));
  const double grown_s2 = unseen_s_ * unseen_s_ - before_s * before_s;
  result_.covariance.topLeftCorner<3, 3>().diagonal().array() += kUnseenSpeedMps * kUnseenSpeedMps * grown_s2;
  result_.covariance.bottomRightCorner<3, 3>().diagonal().array() += kUnseenTurnRadps * kUnseenTurnRadps * grown_s2;
}

// States change with hysteresis: OK is left at once when support is weak and regained after several good frames.
void Tracker::update_state(bool tracked) {
  const TrackOptions& limits = options_.track;
  if (!tracked) {
    good_frames_ = 0;
    hold_pose();
    if (++bad_frames_ >= limits.frames_to_lost) result_.state = TrackState::lost;
    if (result_.state != TrackState::lost) result_.state = TrackState::degraded;
    return;
  }
  const bool followed = bad_frames_ == 0;  // else the last pose was only held, or this one was found elsewhere
  bad_frames_ = 0;
  unseen_s_ = 0.0;
  good_frames_ = result_.num_landmarks >= limits.min_inliers_ok ? good_frames_ + 1 : 0;
  const bool ok = result_.state == TrackState::ok ? good_frames_ > 0 : good_frames_ >= limits.frames_to_recover;
  result_.state = ok ? TrackState::ok : TrackState::degraded;
  regaining_ = !ok && (regaining_ || !followed);
  if (!followed) return;  // odom goes on from where it stood: what happened unseen is the map's to know
  const Rigid3 T_before_now = last_.T_camera_world * frame_.T_camera_world.inverse();
  motion_.moved(T_before_now, frame_.stamp - last_.stamp);
  result_.T_odom_camera = result_.T_odom_camera * T_before_now;
}

// Keeps the frame if the map lacks it, and asks for smoothing around it.
void Tracker::upkeep() {
  if (options_.map.mode == "localise" || regaining_) return name_reference();  // nothing is learned in doubt
  if (newest_keyframe_ == kNone || !map_.keyframe(newest_keyframe_).alive) newest_keyframe_ = local_map_.reference();
  const bool weak = result_.num_landmarks < 2 * options_.track.min_inliers_ok;
  if (keyframer_.wanted(frame_, map_, newest_keyframe_, result_.num_landmarks, weak)) {
    newest_keyframe_ = keyframer_.insert(map_, builder_, frame_, result_.covariance, reference_id_);
    reference_id_ = map_.keyframe(newest_keyframe_).id;
    result_.keyframe = true;
    keyframer_.cull(map_, newest_keyframe_);
    places_.update(map_);
    loops_.look(map_, places_.index(), newest_keyframe_, frame_.index);
    std::copy_n(map_.keyframe(newest_keyframe_).landmark.begin(), frame_.size(), frame_.landmark.begin());
  }
  if (problem_state_ == ProblemState::idle) ask_for_smoothing();
  name_reference();
}

// Where a loop was closed first, then around what was just learned.
void Tracker::ask_for_smoothing() {
  const std::int32_t seam = loops_.next_to_smooth(map_);
  const std::int32_t wanted = seam == kNone && result_.keyframe ? newest_keyframe_ : seam;
  if (wanted == kNone || !smooth_exchange_.cut(map_, wanted, frame_.index, refiner_.sigma_px(), problem_)) return;
  problem_state_ = ProblemState::offered;
  problem_outdated_ = false;
}

void Tracker::name_reference() {
  result_.reference_keyframe = reference_id_;
  const auto T_world_reference = map_.keyframe_pose(reference_id_);
  if (T_world_reference) result_.T_reference_camera = T_world_reference->inverse() * result_.T_world_camera;
}

SmoothProblem* Tracker::take_problem() {
  if (problem_state_ != ProblemState::offered) return nullptr;
  problem_state_ = ProblemState::out;
  return &problem_;
}

void Tracker::give_back(SmoothProblem* problem) {
  EXPECTS(problem == &problem_ && problem_state_ == ProblemState::out);
  problem_state_ = ProblemState::answered;
}

MapMeta Tracker::meta() const {
  MapMeta meta;
  meta.map_version = result_.map_version;
  meta.vocabulary = places_.vocabulary();
  return meta;
}

MapChange* Tracker::take_change() {
  if (options_.map.mode == "localise") return nullptr;
  return journal_.advance(map_, meta(), frame_.stamp);
}

MapChange* Tracker::collect_change() {
  if (options_.map.mode == "localise") return nullptr;
  return journal_.collect(map_, meta());
}

}  // namespace povslam
