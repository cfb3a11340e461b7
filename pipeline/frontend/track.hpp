// The tracker: each frame's camera pose against the map it builds on the way. One thread; after the first frames it
// neither allocates nor locks. Order of attempts: where motion predicts it (widening), the local map, the whole nearby
// map; failing that the pose is held, its covariance grows, and the map is searched.
#pragma once

#include <memory>

#include "pipeline/frontend/keyframer.hpp"
#include "pipeline/frontend/local_map.hpp"
#include "pipeline/frontend/map.hpp"
#include "pipeline/frontend/match.hpp"
#include "pipeline/frontend/noise_scale.hpp"
#include "pipeline/frontend/relocalise.hpp"
#include "pipeline/frontend/smooth_exchange.hpp"
#include "pipeline/frontend/solve_pose.hpp"
#include "pipeline/frontend/track_state.hpp"
#include "pipeline/frontend/turn_prior.hpp"

namespace povslam {

struct TrackResult {
  TrackState state = TrackState::initialising;
  Rigid3 T_world_camera;
  Rigid3 T_odom_camera;                    // continuous
  Matrix6d covariance = Matrix6d::Zero();  // of T_world_camera (see Rigid3)
  int num_features = 0;
  int num_landmarks = 0;
  bool keyframe = false;
  std::int64_t reference_keyframe = -1;
  Rigid3 T_reference_camera;
  TimeNs features_ns = 0, track_ns = 0, keyframe_ns = 0;  // CPU of this thread
};

class Tracker {
 public:
  Tracker(const PinholeCamera& camera, const FrontendOptions& options, const Rigid3& T_world_camera_start);

  const TrackResult& track(const RgbdFrame& input);

  SmoothProblem* take_problem();
  void give_back(SmoothProblem* problem);

  const Map& map() const { return map_; }

 private:
  void apply_answer();
  void start_map();
  Rigid3 predict() const;
  bool track_motion(const Rigid3& predicted);
  int match_last(const Rigid3& predicted, float radius_px);
  bool track_local_map(bool wide);
  bool refine_matches(const PoseSolution& solution);
  int match_local_map(const Rigid3& T_camera_world, bool wide);
  void observe_matches(bool with_points_of_last);
  bool relocalise();
  void learn_noise(const PoseSolution& solution);
  void accept(const PoseSolution& solution);
  void update_state(bool tracked);
  void upkeep();
  void hold_pose();
  void compensate_motion();

  PinholeCamera camera_;
  FrontendOptions options_;
  FrameBuilder builder_;
  Map map_;
  LocalMap local_map_;
  Keyframer keyframer_;
  SmoothExchange smooth_exchange_;
  Relocaliser relocaliser_;
  Matcher matcher_;
  TurnPrior turn_prior_;
  NoiseScale depth_noise_, patch_noise_;
  std::vector<float> placed_level_scale_;  // of a feature placed by its patch: scale of the level; else 0
  Frame frame_, last_;
  std::vector<PoseObservation> observations_;
  std::vector<std::int32_t> observed_feature_;  // of each observation
  PoseSolution solution_;
  TrackResult result_;

  Rigid3 T_world_camera_start_;
  Rigid3 velocity_;  // T_camera_lastcamera of the last two frames
  bool have_velocity_ = false;
  TimeNs velocity_span_ = 0;
  Vector6d twist_ = Vector6d::Zero();  // camera's motion in its own axes at the last frame [m/s, rad/s]
  std::int32_t newest_keyframe_ = kNone;
  std::int64_t reference_id_ = -1;
  std::int64_t frame_index_ = 0;
  int last_matches_ = 0;  // how many points of the last frame were found in the one after it
  int good_frames_ = 0, bad_frames_ = 0;
  std::int32_t search_cursor_ = 0;

  SmoothProblem problem_;
  enum class ProblemState { idle, offered, out, answered } problem_state_ = ProblemState::idle;
};

}  // namespace povslam
