#include "pipeline/frontend/track.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace povslam {

namespace {
constexpr int kMinToStart = 80;        // features with depth to begin a map
constexpr int kMinFromMotion = 20;     // matches that make a motion search worth solving
constexpr double kMinFitting = 0.4;    // share of the matches that must agree on the pose
constexpr double kMinAgreement = 0.5;  // of thumbnails before the turn they tell is believed
constexpr int kMinToRelocalise = 40;   // fitting landmarks before a found place is believed
constexpr int kSearchedPerFrame = 3;   // keyframes tried each frame while lost
constexpr float kLocalRadiusPx = 4.0F;
constexpr double kMaxViewAngleCos = 0.45;
constexpr std::int32_t kPointOfLast = 1 << 30;  // matcher tags: landmark slots, or this + feature of the last frame

double level_offset(double distance_ratio, double log_scale) { return std::log(distance_ratio) / log_scale; }
}  // namespace

Tracker::Tracker(const PinholeCamera& camera, const FrontendOptions& options, const Rigid3& T_world_camera_start)
    : camera_(camera),
      options_(options),
      builder_(camera, options),
      map_(options.orb.num_features, options.map, builder_.level_scales()),
      local_map_(options.map),
      keyframer_(camera, options),
      smooth_exchange_(camera, options),
      relocaliser_(camera, options),
      matcher_(options.orb.num_features),
      turn_prior_(camera),
      depth_noise_(static_cast<std::size_t>(options.orb.num_features)),
      patch_noise_(static_cast<std::size_t>(options.orb.num_features)),
      placed_level_scale_(static_cast<std::size_t>(options.orb.num_features)),
      frame_(camera, options),
      last_(camera, options),
      T_world_camera_start_(T_world_camera_start) {
  observations_.reserve(static_cast<std::size_t>(options.orb.num_features));
  observed_feature_.reserve(static_cast<std::size_t>(options.orb.num_features));
  smooth_exchange_.reserve(problem_);
}

const TrackResult& Tracker::track(const RgbdFrame& input) {
  const TimeNs start = thread_cpu_now();
  result_.keyframe = false;
  apply_answer();
  std::swap(frame_, last_);
  builder_.build(input, depth_noise_.value(), frame_);
  std::fill(placed_level_scale_.begin(), placed_level_scale_.end(), 0.0F);
  frame_.index = frame_index_++;
  turn_prior_.look(builder_.images());
  const TimeNs built = thread_cpu_now();
  result_.num_features = frame_.size();
  bool tracked = false;
  if (result_.state == TrackState::initialising) {
    start_map();
    tracked = result_.state != TrackState::initialising;
  } else if (result_.state == TrackState::lost) {
    tracked = relocalise();
  } else {
    const Rigid3 predicted = predict();
    frame_.T_camera_world = predicted;
    compensate_motion();
    tracked = track_motion(predicted);
    last_matches_ = tracked ? solution_.num_inliers : 0;
    if (tracked) compensate_motion();
    tracked = tracked && track_local_map(false);
    if (!tracked) tracked = relocalise();
  }
  const TimeNs posed = thread_cpu_now();
  if (result_.state != TrackState::initialising) {
    update_state(tracked);
    if (tracked) upkeep();
  }
  result_.features_ns = built - start;
  result_.track_ns = posed - built;
  result_.keyframe_ns = thread_cpu_now() - posed;
  return result_;
}

void Tracker::start_map() {
  int with_depth = 0;
  for (int i = 0; i < frame_.size(); ++i) with_depth += frame_.has_depth(i) ? 1 : 0;
  result_.T_world_camera = T_world_camera_start_;
  if (with_depth < kMinToStart) return;
  frame_.T_camera_world = T_world_camera_start_.inverse();
  newest_keyframe_ = keyframer_.insert(map_, builder_, frame_, Matrix6d::Zero(), -1);
  reference_id_ = map_.keyframe(newest_keyframe_).id;
  result_.state = TrackState::ok;
  result_.keyframe = true;
  result_.num_landmarks = map_.num_landmarks();
  result_.reference_keyframe = reference_id_;
  result_.T_reference_camera = Rigid3{};
}

Rigid3 Tracker::predict() const {
  if (!have_velocity_ || velocity_span_ <= 0) return last_.T_camera_world;
  // The same speed over the time that really passed (a dropped frame doubles it).
  const double share = std::clamp(to_seconds(frame_.stamp - last_.stamp) / to_seconds(velocity_span_), 0.0, 4.0);
  return se3_exp(share * se3_log(velocity_)) * last_.T_camera_world;
}

bool Tracker::track_motion(const Rigid3& predicted) {
  const float radius = static_cast<float>(options_.track.search_radius_px);
  // A prediction is good when most of what the last frame saw is found again where it says.
  const int strong = std::max(kMinFromMotion, last_matches_ / 2);
  const int best = match_last(predicted, radius);
  if (best >= strong) return true;
  const TurnPrior::Turn turn =
      turn_prior_.estimate((predicted.rotation * last_.T_camera_world.rotation.conjugate()).normalized());
  if (turn.agreement > kMinAgreement) {
    const Rigid3 turned = Rigid3{turn.R_now_before, Eigen::Vector3d::Zero()} * last_.T_camera_world;
    const int found = match_last(turned, radius);
    if (found >= strong) return true;
    if (std::max(found, match_last(turned, 2.0F * radius)) > std::max(best, kMinFromMotion)) return true;
  }
  if (match_last(predicted, 2.0F * radius) >= kMinFromMotion) return true;
  return match_last(last_.T_camera_world, 4.0F * radius) >= kMinFromMotion;
}

// Points the last frame saw (landmarks, and what its depth says of other features) searched around their predicted place.
// Returns how many fit the pose that came out, 0 when none did; the frame then has that pose and its landmarks.
int Tracker::match_last(const Rigid3& predicted, float radius_px) {
  matcher_.start(frame_);
  const Rigid3 T_world_last = last_.T_camera_world.inverse();
  const double log_scale = map_.num_levels() > 1 ? std::log(map_.level_scale(1)) : 1.0;
  for (int i = 0; i < last_.size(); ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const std::int32_t seen = last_.landmark[k];
    if (seen == kNone && !last_.has_depth(i)) continue;
    const Eigen::Vector3d p_world =
        seen != kNone ? map_.landmark(seen).p_world : T_world_last * last_.point_camera(i, camera_);
    const Eigen::Vector3d p = predicted * p_world;
    if (p.z() < 0.05) continue;
    const double distance_last = (last_.T_camera_world * p_world).norm();
    const int level = last_.features.level[k] + static_cast<int>(std::lround(level_offset(distance_last / p.norm(), log_scale)));
    MatchCandidate c;
    c.u_px = static_cast<float>(camera_.fx * p.x() / p.z() + camera_.cx);
    c.v_px = static_cast<float>(camera_.fy * p.y() / p.z() + camera_.cy);
    c.radius_px = radius_px * std::sqrt(map_.level_scale(std::clamp(level, 0, map_.num_levels() - 1)));
    c.min_level = static_cast<std::int8_t>(level - 1);
    c.max_level = static_cast<std::int8_t>(level + 1);
    c.descriptor = &last_.features.descriptor[k];
    c.tag = seen != kNone ? seen : kPointOfLast + i;
    matcher_.match(frame_, c, kMaxDistance, 0.9);
  }
  if (matcher_.count() < kMinFromMotion) return 0;
  observe_matches(true);
  PoseSolverOptions solver;
  solver.first_gate = 4.0;
  solution_ = solve_pose(camera_, predicted, observations_, solver);
  if (!solution_.converged || solution_.num_inliers < kMinFromMotion || solution_.num_inliers < kMinFitting * matcher_.count())
    return 0;
  frame_.T_camera_world = solution_.T_camera_world;
  std::fill_n(frame_.landmark.begin(), frame_.size(), kNone);
  for (std::size_t o = 0; o < observations_.size(); ++o) {
    const std::int32_t tag = matcher_.tag_of(observed_feature_[o]);
    if (observations_[o].fits && tag < kPointOfLast) frame_.landmark[static_cast<std::size_t>(observed_feature_[o])] = tag;
  }
  return solution_.num_inliers;
}

// Turns the matcher's pairs into observations for the pose.
void Tracker::observe_matches(bool with_points_of_last) {
  observations_.clear();
  observed_feature_.clear();
  const Rigid3 T_world_last = last_.T_camera_world.inverse();
  for (int i = 0; i < frame_.size(); ++i) {
    const std::int32_t tag = matcher_.tag_of(i);
    if (tag == kNone) continue;
    const bool of_last = tag >= kPointOfLast;
    if (of_last && !with_points_of_last) continue;
    const std::size_t k = static_cast<std::size_t>(i);
    PoseObservation o;
    double point_variance = 1.0;  // of the point's own inverse depth, in units of a reading's
    if (of_last) {
      o.p_world = T_world_last * last_.point_camera(tag - kPointOfLast, camera_);
    } else {
      const Landmark& point = map_.landmark(tag);
      o.p_world = point.p_world;
      point_variance = 1.0 / point.num_sightings;
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

int Tracker::match_local_map(const Rigid3& T_camera_world, bool wide) {
  matcher_.start(frame_);
  const Rigid3 T_world_camera = T_camera_world.inverse();
  const Eigen::Matrix3d R = T_camera_world.matrix3();
  const double log_scale = map_.num_levels() > 1 ? std::log(map_.level_scale(1)) : 1.0;
  int visible = 0;
  for (const LocalLandmark& local : local_map_.landmarks()) {
    Landmark& point = map_.landmark(local.slot);
    const Eigen::Vector3d p = R * point.p_world + T_camera_world.translation;
    if (p.z() < 0.1) continue;
    MatchCandidate c;
    c.u_px = static_cast<float>(camera_.fx * p.x() / p.z() + camera_.cx);
    c.v_px = static_cast<float>(camera_.fy * p.y() / p.z() + camera_.cy);
    if (!camera_.contains({c.u_px, c.v_px})) continue;
    const Eigen::Vector3d toward = T_world_camera.translation - point.p_world;
    const double distance = toward.norm();
    if (toward.dot(point.toward_camera) < kMaxViewAngleCos * distance) continue;
    const double level = point.reference_level + level_offset(point.reference_distance_m / distance, log_scale);
    if (level < -1.5 || level > map_.num_levels() + 0.5) continue;
    const int nearest_level = std::clamp(static_cast<int>(std::lround(level)), 0, map_.num_levels() - 1);
    ++visible;
    ++point.visible;
    const float radius = wide ? 4.0F * kLocalRadiusPx : (local.remote ? 2.0F * kLocalRadiusPx : kLocalRadiusPx);
    c.radius_px = radius * map_.level_scale(nearest_level);
    c.min_level = static_cast<std::int8_t>(nearest_level - 1);
    c.max_level = static_cast<std::int8_t>(nearest_level + 1);
    c.descriptor = &point.descriptor;
    c.tag = local.slot;
    matcher_.match(frame_, c, kMaxDistance, kNearestRatio);
  }
  return visible;
}

// Fits the patch of each landmark that agreed with the pose, for a sharper position of its feature.
bool Tracker::refine_matches(const PoseSolution& solution) {
  static const bool kRefine = getenv("NOREF") == nullptr;
  if (!kRefine || !solution.converged) return false;
  const double log_scale = map_.num_levels() > 1 ? std::log(map_.level_scale(1)) : 1.0;
  int refined = 0;
  for (std::size_t o = 0; o < observations_.size(); ++o) {
    if (!observations_[o].fits) continue;
    const int feature = observed_feature_[o];
    const std::size_t k = static_cast<std::size_t>(feature);
    const std::int32_t slot = matcher_.tag_of(feature);
    const Landmark& point = map_.landmark(slot);
    if (!point.has_patch) continue;
    const auto centre = camera_.project(solution.T_camera_world * point.p_world);
    const auto along_x = camera_.project(solution.T_camera_world * (point.p_world + point.tangent_x.cast<double>()));
    const auto along_y = camera_.project(solution.T_camera_world * (point.p_world + point.tangent_y.cast<double>()));
    if (!centre || !along_x || !along_y) continue;
    Eigen::Matrix2d image_per_patch;
    image_per_patch << *along_x - *centre, *along_y - *centre;
    const double size = std::sqrt(std::abs(image_per_patch.determinant()));
    if (!(size > 0.4)) continue;
    const int level_index = std::clamp(static_cast<int>(std::lround(std::log(size) / log_scale)), 0, map_.num_levels() - 1);
    const PyramidLevel& level = builder_.level(level_index);
    const Eigen::Matrix2d inverse = (image_per_patch / level.scale).inverse();
    const float patch_per_image[4] = {static_cast<float>(inverse(0, 0)), static_cast<float>(inverse(0, 1)),
                                      static_cast<float>(inverse(1, 0)), static_cast<float>(inverse(1, 1))};
    const float x = (frame_.features.x[k] + 0.5F) / level.scale - 0.5F, y = (frame_.features.y[k] + 0.5F) / level.scale - 0.5F;
    const PatchPlace place = find_patch(map_.patch(slot), patch_per_image, level, x, y, 2.5F);
    if (!place.converged || place.correlation < 0.8F) continue;
    builder_.place(frame_, feature, (place.x + 0.5F) * level.scale - 0.5F, (place.y + 0.5F) * level.scale - 0.5F,
                   static_cast<float>(options_.noise.patch_sigma_px * patch_noise_.value()) * level.scale);
    placed_level_scale_[k] = level.scale;
    ++refined;
  }
  if (refined > 0) compensate_motion();

  if (getenv("DBG")) printf("refined %d of %zu  ", refined, observations_.size());
  return refined > 0;
}

// The camera's speed in the middle of this frame, from the mean speeds since the last frame and before.
void Tracker::compensate_motion() {
  static const double kReadout = getenv("RS") ? atof(getenv("RS")) : 0.0;
  const double span_s = to_seconds(frame_.stamp - last_.stamp);
  if (!have_velocity_ || kReadout == 0.0 || span_s <= 0.0) return;
  const Vector6d mean = se3_log(last_.T_camera_world * frame_.T_camera_world.inverse()) / span_s;
  const Vector6d twist = mean + 0.5 * (mean - twist_);
  frame_.compensate_motion(camera_, twist, kReadout);
}

bool Tracker::track_local_map(bool wide) {
  local_map_.collect(map_, frame_, frame_.T_camera_world.inverse());
  match_local_map(frame_.T_camera_world, wide);
  observe_matches(false);
  PoseSolverOptions solver;
  solver.first_gate = wide ? 9.0 : 2.0;
  PoseSolution solution = solve_pose(camera_, frame_.T_camera_world, observations_, solver);
  if (refine_matches(solution)) {
    observe_matches(false);
    solver.first_gate = 2.0;
    solution = solve_pose(camera_, solution.T_camera_world, observations_, solver);
  }
  const bool enough = solution.converged && solution.num_inliers >= options_.track.min_inliers_degraded;
  if (getenv("DBG2")&&frame_.index%20==0) { for (size_t k=0;k<observations_.size();++k){ auto&o=observations_[k]; int f=observed_feature_[k]; Eigen::Vector3d p=solution.T_camera_world*o.p_world; double du=camera_.fx*p.x()/p.z()+camera_.cx-o.u_px,dv=camera_.fy*p.y()/p.z()+camera_.cy-o.v_px; double e=(1/p.z()-o.inverse_depth_per_m); bool ref=std::abs(frame_.sigma_px[f]-options_.noise.pixel_sigma_px*map_.level_scale(frame_.features.level[f]))>1e-4; printf("OBS %ld ref %d fits %d sig %.2f sd %.5f hd %d du %.3f dv %.3f e %.5f lev %d ns %d z %.2f\n",frame_.index,ref,o.fits,frame_.sigma_px[f],frame_.sigma_inverse_depth[f],o.weight_inverse_depth>0,du,dv,e,frame_.features.level[f],map_.landmark(matcher_.tag_of(f)).num_sightings,p.z()); } }
  if (getenv("DBG")) { std::vector<double> px,d; double n=0,bx=0,by=0; for (auto&o:observations_){ Eigen::Vector3d p=solution.T_camera_world*o.p_world; double du=camera_.fx*p.x()/p.z()+camera_.cx-o.u_px,dv=camera_.fy*p.y()/p.z()+camera_.cy-o.v_px; px.push_back(std::sqrt(du*du+dv*dv)); if(o.weight_inverse_depth>0){double e=(1/p.z()-o.inverse_depth_per_m);d.push_back(std::abs(e)*std::sqrt(o.weight_inverse_depth));} n++;bx+=du;by+=dv;} std::sort(px.begin(),px.end());std::sort(d.begin(),d.end()); printf("f %ld obs %zu inl %d dinl %d px med %.2f p80 %.2f | d/sig med %.2f p80 %.2f\n",frame_.index,px.size(),solution.num_inliers,solution.num_depth_inliers,px[px.size()/2],px[px.size()*8/10],d[d.size()/2],d[d.size()*8/10]); }
  if (!enough) return false;
  std::fill_n(frame_.landmark.begin(), frame_.size(), kNone);
  for (std::size_t o = 0; o < observations_.size(); ++o) {
    if (!observations_[o].fits) continue;
    const std::int32_t slot = matcher_.tag_of(observed_feature_[o]);
    frame_.landmark[static_cast<std::size_t>(observed_feature_[o])] = slot;
    ++map_.landmark(slot).found;
  }
  learn_noise(solution);
  accept(solution);
  return true;
}

// Residuals of matched landmarks tell how good pixels and depths of this camera are.
void Tracker::learn_noise(const PoseSolution& solution) {
  depth_noise_.start();
  patch_noise_.start();
  const double patch_sigma = options_.noise.patch_sigma_px;
  for (std::size_t i = 0; i < observations_.size(); ++i) {
    const PoseObservation& o = observations_[i];
    if (!o.fits) continue;
    const std::size_t k = static_cast<std::size_t>(observed_feature_[i]);
    const Eigen::Vector3d p = solution.T_camera_world * o.p_world;
    if (o.weight_inverse_depth > 0.0) {
      depth_noise_.add(std::abs(1.0 / p.z() - o.inverse_depth_per_m) * std::sqrt(o.weight_inverse_depth) *
                       depth_noise_.value());
    }
    if (placed_level_scale_[k] > 0.0F) {
      const double du = camera_.fx * p.x() / p.z() + camera_.cx - o.u_px;
      const double dv = camera_.fy * p.y() / p.z() + camera_.cy - o.v_px;
      patch_noise_.add(std::sqrt(du * du + dv * dv) / (patch_sigma * placed_level_scale_[k]));
    }
  }
  depth_noise_.finish(0.6745);  // |normal|
  patch_noise_.finish(1.1774);  // two dimensions
}

void Tracker::accept(const PoseSolution& solution) {
  solution_ = solution;
  frame_.T_camera_world = solution.T_camera_world;
  result_.T_world_camera = solution.T_camera_world.inverse();
  result_.num_landmarks = solution.num_inliers;
  if (local_map_.reference() != kNone) reference_id_ = map_.keyframe(local_map_.reference()).id;
  // xi perturbs T_camera_world on the left; Rigid3's covariance is of the camera's place and turn in the world.
  const Matrix6d sigma = (solution.information + 1e-9 * Matrix6d::Identity()).inverse();
  const Eigen::Matrix3d R = result_.T_world_camera.matrix3();
  Matrix6d J = Matrix6d::Zero();
  J.topLeftCorner<3, 3>() = -R;
  J.bottomRightCorner<3, 3>() = -R;
  result_.covariance = J * sigma * J.transpose();
}

bool Tracker::relocalise() {
  // The newest places first, then the whole map in turn.
  std::int32_t tried = 0;
  const auto attempt = [this](std::int32_t slot) {
    const auto found = relocaliser_.against(map_, slot, frame_);
    if (!found) return false;
    std::fill_n(frame_.landmark.begin(), frame_.size(), kNone);
    frame_.T_camera_world = found->T_camera_world;
    if (!track_local_map(true)) return false;
    if (!track_local_map(false)) return false;
    return solution_.num_inliers >= kMinToRelocalise;
  };
  const Rigid3 held = result_.T_world_camera;
  const Matrix6d held_covariance = result_.covariance;
  if (newest_keyframe_ != kNone && map_.keyframe(newest_keyframe_).alive && attempt(newest_keyframe_)) return true;
  for (std::int32_t step = 0; step < map_.keyframe_slots() && tried < kSearchedPerFrame; ++step) {
    search_cursor_ = (search_cursor_ + 1) % map_.keyframe_slots();
    if (!map_.keyframe(search_cursor_).alive || search_cursor_ == newest_keyframe_) continue;
    ++tried;
    if (attempt(search_cursor_)) return true;
  }
  result_.T_world_camera = held;
  result_.covariance = held_covariance;
  return false;
}

void Tracker::hold_pose() {
  frame_.T_camera_world = result_.T_world_camera.inverse();
  std::fill_n(frame_.landmark.begin(), frame_.size(), kNone);
  have_velocity_ = false;
  result_.num_landmarks = 0;
  // Unseen motion: a robot's speed, until it is found again.
  const double dt_s = std::clamp(to_seconds(frame_.stamp - last_.stamp), 0.0, 1.0);
  const double move_m = 1.0 * dt_s, turn_rad = 1.0 * dt_s;
  result_.covariance.topLeftCorner<3, 3>().diagonal().array() += move_m * move_m;
  result_.covariance.bottomRightCorner<3, 3>().diagonal().array() += turn_rad * turn_rad;
}

void Tracker::update_state(bool tracked) {
  const TrackOptions& limits = options_.track;
  if (!tracked) {
    good_frames_ = 0;
    ++bad_frames_;
    hold_pose();
    if (result_.state != TrackState::lost) {
      result_.state = bad_frames_ >= limits.frames_to_lost ? TrackState::lost : TrackState::degraded;
    }
  } else {
    bad_frames_ = 0;
    const bool strong = result_.num_landmarks >= limits.min_inliers_ok;
    good_frames_ = strong ? good_frames_ + 1 : 0;
    if (!strong) {
      result_.state = TrackState::degraded;
    } else if (result_.state != TrackState::ok) {
      result_.state = good_frames_ >= limits.frames_to_recover ? TrackState::ok : TrackState::degraded;
    }
    const Rigid3 step = frame_.T_camera_world * last_.T_camera_world.inverse();
    velocity_ = step;
    velocity_span_ = frame_.stamp - last_.stamp;
    twist_ = velocity_span_ > 0 ? Vector6d(se3_log(step.inverse()) / to_seconds(velocity_span_)) : Vector6d::Zero();
    have_velocity_ = frame_.index > 0;
    result_.T_odom_camera = result_.T_odom_camera * step.inverse();
  }
}

void Tracker::upkeep() {
  const bool weak = result_.num_landmarks < 2 * options_.track.min_inliers_ok;
  if (newest_keyframe_ != kNone && !map_.keyframe(newest_keyframe_).alive) newest_keyframe_ = local_map_.reference();
  if (!result_.keyframe && keyframer_.wanted(frame_, map_, newest_keyframe_, result_.num_landmarks, weak)) {
    newest_keyframe_ = keyframer_.insert(map_, builder_, frame_, result_.covariance, reference_id_);
    reference_id_ = map_.keyframe(newest_keyframe_).id;
    result_.keyframe = true;
    keyframer_.cull(map_, newest_keyframe_);
    for (int i = 0; i < frame_.size(); ++i) {  // culling may have removed what this frame saw
      std::int32_t& seen = frame_.landmark[static_cast<std::size_t>(i)];
      seen = map_.keyframe(newest_keyframe_).landmark[static_cast<std::size_t>(i)];
    }
    if (problem_state_ == ProblemState::idle &&
        smooth_exchange_.cut(map_, newest_keyframe_, frame_.index, problem_)) {
      problem_state_ = ProblemState::offered;
    }
  }
  result_.reference_keyframe = reference_id_;
  if (const auto T = map_.keyframe_pose(reference_id_)) result_.T_reference_camera = T->inverse() * result_.T_world_camera;
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

void Tracker::apply_answer() {
  if (problem_state_ != ProblemState::answered) return;
  problem_state_ = ProblemState::idle;
  const Rigid3 T_new_old = smooth_exchange_.apply(map_, problem_, reference_id_);
  result_.T_world_camera = T_new_old * result_.T_world_camera;
  frame_.T_camera_world = frame_.T_camera_world * T_new_old.inverse();
  for (int i = 0; i < frame_.size(); ++i) {
    std::int32_t& seen = frame_.landmark[static_cast<std::size_t>(i)];
    if (seen != kNone && !map_.landmark(seen).alive) seen = kNone;
  }
}

}  // namespace povslam
