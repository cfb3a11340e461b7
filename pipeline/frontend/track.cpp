#include "pipeline/frontend/track.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/frontend/pose_covariance.hpp"

namespace povslam {

namespace {
constexpr double kMinFitting = 0.4;      // share of the points of the last frame that must agree on a pose
constexpr double kMinAgreement = 0.5;    // of thumbnails before the turn they tell is believed
constexpr int kMinToRelocalise = 40;     // fitting landmarks before a found place is believed
constexpr float kWide = 4.0F;            // widening of the local search around a found place
constexpr int kMinJoined = 40;           // fitting landmarks that say alone where the camera is
constexpr float kRemoteWidening = 2.0F;  // else: of the search for what an older visit left
constexpr double kUnseenSpeedMps = 1.0;  // how fast the pose may leave us while nothing is seen
constexpr double kUnseenTurnRadps = 1.0;
// No robot, nor a hand, moves faster between the last pose and this one; what would have to is somewhere else.
constexpr double kStepM = 0.05, kMaxSpeedMps = 4.0, kStepRad = 0.05, kMaxTurnRadps = 6.0;
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

// Returns how many of the last frame's points fit the pose that came out, 0 when that is no pose to trust; else the
// frame then has this pose and its landmarks.
int Tracker::match_last(const Rigid3& T_camera_world, float radius_px) {
  frame_.T_camera_world = T_camera_world;
  compensate_shutter();
  search_.match_last(map_, last_, frame_, T_camera_world, radius_px, matcher_);
  if (matcher_.count() < kMinFromLast) return 0;
  observe_matches();
  PoseSolverOptions solver;
  solver.first_gate = 4.0;
  const PoseSolution solution = solve_pose(camera_, T_camera_world, observations_, solver);
  if (!solution.converged || solution.num_inliers < std::max<double>(kMinFromLast, kMinFitting * matcher_.count())) {
    return 0;
  }
  frame_.T_camera_world = solution.T_camera_world;
  take_landmarks();
  return solution.num_inliers;
}

bool Tracker::track_local_map(const Rigid3& T_camera_world, float widening) {
  frame_.T_camera_world = T_camera_world;
  compensate_shutter();
  local_map_.collect(map_, frame_, T_camera_world.inverse());
  PoseSolution solution = match_local_map(T_camera_world, widening, widening > 1.0F ? 9.0 : 2.0);
  if (solution.converged && refine_matches(solution) > 0) {
    frame_.T_camera_world = solution.T_camera_world;
    compensate_shutter();
    observe_matches();
    PoseSolverOptions solver;
    solver.first_gate = 2.0;
    solution = solve_pose(camera_, solution.T_camera_world, observations_, solver);
  }
  if (!solution.converged || solution.num_inliers < options_.track.min_inliers_degraded) return false;
  take_landmarks();
  for (int i = 0; i < frame_.size(); ++i) {
    const std::int32_t seen = frame_.landmark[static_cast<std::size_t>(i)];
    if (seen != kNone) ++map_.landmark(seen).found;
  }
  learn_noise(solution);
  accept(solution);
  return true;
}

// An older visit's landmarks lie off by the drift since. Were all matched alike, both copies of the place would pull,
// and what most of them fit may be a pose of neither. So what hangs together with the last frames says where the camera
// is, if there is enough of it; of the rest that joins which agrees.
PoseSolution Tracker::match_local_map(const Rigid3& T_camera_world, float widening, double gate) {
  PoseSolverOptions solver;
  solver.first_gate = gate;
  search_.match_local(map_, local_map_.joined(), frame_, T_camera_world, widening, matcher_);
  observe_matches();
  PoseSolution solution = solve_pose(camera_, T_camera_world, observations_, solver);
  if (local_map_.remote().empty()) return solution;
  const bool enough = solution.converged && solution.num_inliers >= kMinJoined;
  const Rigid3 T_known = enough ? solution.T_camera_world : T_camera_world;
  search_.match_more(map_, local_map_.remote(), frame_, T_known, enough ? 1.0F : kRemoteWidening * widening, matcher_);
  observe_matches();
  solver.first_gate = enough ? 1.0 : gate;
  return solve_pose(camera_, T_known, observations_, solver);
}

// Turns the matcher's pairs into observations for the pose.
void Tracker::observe_matches() {
  observations_.clear();
  observed_feature_.clear();
  const Rigid3 T_world_last = last_.T_camera_world.inverse();
  for (int i = 0; i < frame_.size(); ++i) {
    const std::int32_t tag = matcher_.tag_of(i);
    if (tag == kNone) continue;
    const std::size_t k = static_cast<std::size_t>(i);
    PoseObservation o;
    o.trust = tag < kPointOfLast ? map_.trust(tag) : 1.0;
    double point_variance = 1.0;  // of the point's own inverse depth, in units of one reading's
    if (tag >= kPointOfLast) {
      o.p_world = T_world_last * last_.point_camera(tag - kPointOfLast, camera_);
    } else {
      o.p_world = map_.landmark(tag).p_world;
      point_variance = 1.0 / map_.landmark(tag).num_sightings;
    }
    const double sigma_px = frame_.sigma_px[k];
    o.u_px = frame_.x[k];
    o.v_px = frame_.y[k];
    o.weight_px = 1.0 / (sigma_px * sigma_px);
    if (frame_.has_depth(i)) {
      const double sigma_d = frame_.sigma_inverse_depth[k];
      o.inverse_depth_per_m = frame_.inverse_depth[k];
      o.weight_inverse_depth = 1.0 / (sigma_d * sigma_d * (1.0 + point_variance));
    }
    observations_.push_back(o);
    observed_feature_.push_back(i);
  }
}

int Tracker::refine_matches(const PoseSolution& solution) {
  int refined = 0;
  for (std::size_t o = 0; o < observations_.size(); ++o) {
    if (!observations_[o].fits) continue;
    const int feature = observed_feature_[o];
    const std::int32_t slot = matcher_.tag_of(feature);
    if (refiner_.refine(map_, slot, builder_, solution.T_camera_world, frame_, feature)) ++refined;
  }
  return refined;
}

// The frame keeps the landmarks whose observations fit.
void Tracker::take_landmarks() {
  std::fill_n(frame_.landmark.begin(), frame_.size(), kNone);
  std::fill_n(frame_.misfit.begin(), frame_.size(), kNone);
  for (std::size_t o = 0; o < observations_.size(); ++o) {
    const std::int32_t tag = matcher_.tag_of(observed_feature_[o]);
    if (tag >= kPointOfLast) continue;
    auto& kept = observations_[o].fits ? frame_.landmark : frame_.misfit;
    kept[static_cast<std::size_t>(observed_feature_[o])] = tag;
  }
}

void Tracker::learn_noise(const PoseSolution& solution) {
  depth_noise_.start();
  refiner_.start_learning();
  for (std::size_t i = 0; i < observations_.size(); ++i) {
    const PoseObservation& o = observations_[i];
    if (!o.fits) continue;
    const Eigen::Vector3d p = solution.T_camera_world * o.p_world;
    if (o.weight_inverse_depth > 0.0) {
      const double whitened = std::abs(1.0 / p.z() - o.inverse_depth_per_m) * std::sqrt(o.weight_inverse_depth);
      depth_noise_.add(whitened * depth_noise_.value());
    }
    const double du = camera_.fx * p.x() / p.z() + camera_.cx - o.u_px;
    const double dv = camera_.fy * p.y() / p.z() + camera_.cy - o.v_px;
    refiner_.learn(observed_feature_[i], std::hypot(du, dv));
  }
  depth_noise_.finish(1.1503);  // of a standard normal's absolute value
  refiner_.finish_learning();
}

// With the pose the frame has now, how fast the camera moves is known, and so where its rows would have seen the
// features at one instant.
void Tracker::compensate_shutter() {
  if (rolling_shutter_s_ == 0.0) return;
  const Rigid3 T_before_now = last_.T_camera_world * frame_.T_camera_world.inverse();
  frame_.compensate_motion(camera_, motion_.speed_after(T_before_now, frame_.stamp - last_.stamp), rolling_shutter_s_);
}

void Tracker::accept(const PoseSolution& solution) {
  frame_.T_camera_world = solution.T_camera_world;
  result_.T_world_camera = solution.T_camera_world.inverse();
  result_.num_landmarks = solution.num_inliers;
  if (local_map_.reference() != kNone) reference_id_ = map_.keyframe(local_map_.reference()).id;
  result_.covariance = covariance_to_landmarks(solution) + covariance_of_anchors(map_, frame_, result_.T_world_camera);
}

// One or two frames lost: at the newest place. Really lost: wherever the map looks like the frame, when no other place
// does and the next frames say so too; a robot that was carried to the twin of where it stood must not be found there.
bool Tracker::relocalise() {
  const TrackResult held = result_;
  motion_.forget();
  const bool found = result_.state == TrackState::lost ? found_at_start() || found_anywhere() : found_near();
  if (!found) {
    result_ = held;
    return false;
  }
  agreement_.forget();
  relocaliser_.start_over();
  start_tries_ = 0;
  return true;
}

bool Tracker::found_near() {
  if (newest_keyframe_ == kNone || !map_.keyframe(newest_keyframe_).alive) return false;
  const auto found = relocaliser_.against(map_, newest_keyframe_, frame_);
  return found && confirm(found->T_camera_world) && moved_possibly();
}

// Since the last pose that was seen, which last_ holds while none is.
bool Tracker::moved_possibly() const {
  const double passed_s = unseen_s_ + std::max(0.0, to_seconds(frame_.stamp - last_.stamp));
  const Rigid3 moved = last_.T_camera_world * frame_.T_camera_world.inverse();
  return moved.translation.norm() <= kStepM + kMaxSpeedMps * passed_s &&
         rotation_angle_rad(moved) <= kStepRad + kMaxTurnRadps * passed_s;
}

bool Tracker::hangs_on_one_thing() {
  things_.clear();
  for (int i = 0; i < frame_.size(); ++i) {
    const std::int32_t seen = frame_.landmark[static_cast<std::size_t>(i)];
    if (seen != kNone) things_.add(map_.landmark(seen).owner);
  }
  return things_.hangs_on_one();
}

bool Tracker::found_anywhere() {
  const Relocaliser::Answer answer = relocaliser_.search(map_, places_.index(), frame_);
  return agreement_.add(answer, frame_.stamp) && confirm(answer.fit.T_camera_world);
}

// Whether the map around a supposed pose shows itself in the frame.
bool Tracker::confirm(const Rigid3& T_camera_world) {
  std::fill_n(frame_.landmark.begin(), frame_.size(), kNone);
  return track_local_map(T_camera_world, kWide) && track_local_map(frame_.T_camera_world, 1.0F) &&
         result_.num_landmarks >= kMinToRelocalise;
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
