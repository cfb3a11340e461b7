// The tracker: each frame's camera pose against the map it builds on the way. One thread; after the first frames it
// neither allocates nor locks. Order of attempts: where motion predicts it, where the images say the camera turned,
// ever wider; then the local map. Failing all, the pose is held, its covariance grows, and the map is searched.
#pragma once

#include <span>
#include <unordered_map>
#include <utility>

#include "pipeline/frames/calibration.hpp"
#include "pipeline/frontend/keyframer.hpp"
#include "pipeline/frontend/landmark_search.hpp"
#include "pipeline/frontend/local_map.hpp"
#include "pipeline/frontend/loop.hpp"
#include "pipeline/frontend/map.hpp"
#include "pipeline/frontend/map_journal.hpp"
#include "pipeline/frontend/map_places.hpp"
#include "pipeline/frontend/match.hpp"
#include "pipeline/frontend/motion_model.hpp"
#include "pipeline/frontend/object_wishes.hpp"
#include "pipeline/frontend/patch_refiner.hpp"
#include "pipeline/frontend/relocalise.hpp"
#include "pipeline/frontend/smooth_exchange.hpp"
#include "pipeline/frontend/solve_pose.hpp"
#include "pipeline/frontend/thing_count.hpp"
#include "pipeline/frontend/track_state.hpp"
#include "pipeline/frontend/turn_prior.hpp"

namespace povslam {

struct TrackResult {
  TrackState state = TrackState::initialising;
  Rigid3 T_world_camera;
  Rigid3 T_odom_camera;                    // continuous
  Matrix6d covariance = Matrix6d::Zero();  // of T_world_camera (see Rigid3)
  int num_features = 0;
  int num_landmarks = 0;  // matched and fitting
  bool keyframe = false;
  std::uint32_t map_version = 0;  // grows with every jump of T_world_camera that no motion of the camera explains
  std::int64_t reference_keyframe = -1;
  Rigid3 T_reference_camera;
  TimeNs features_ns = 0, track_ns = 0, keyframe_ns = 0;  // CPU of this thread
};

class Tracker {
 public:
  // content: an earlier session's map, or null.
  Tracker(const SensorCalibration& calibration, const FrontendOptions& options, const Rigid3& T_world_camera_start,
          const MapContent* content = nullptr);

  const TrackResult& track(const RgbdFrame& input);

  SmoothProblem* take_problem();
  void give_back(SmoothProblem* problem);
  LoopProblem* take_loop() { return loops_.take(); }
  void give_back(LoopProblem* problem) { loops_.give_back(problem); }
  const LoopCounts& loops() const { return loops_.counts(); }

  // See Pipeline.
  MapChange* take_change();
  MapChange* collect_change();
  void give_back(MapChange* change) { journal_.give_back(change); }

  const Map& map() const { return map_; }
  const Frame& frame() const { return frame_; }             // the last one tracked, its landmarks those that fit
  const LocalMap& local_map() const { return local_map_; }  // around the last frame

  // What became known of objects, between two frames. slot < 0: of an earlier session's landmark, by its id.
  void set_owner(std::int32_t slot, std::int64_t landmark, std::int64_t owner);  // of a landmark, if it is still there
  void remove_landmarks(std::span<const std::pair<std::int32_t, std::int64_t>> slot_and_id);
  ObjectTrust& object_trust() { return map_.object_trust(); }
  // The last frame's camera was elsewhere in the world: T_new_old maps points of the world as they were seen to where
  // they are.
  void correct(const Rigid3& T_new_old);

 private:
  static constexpr int kMinFromLast = 20;      // points of the last frame that must agree on a pose
  static constexpr int kMinToRelocalise = 40;  // fitting landmarks before a found place is believed

  void adopt(const MapContent& content);
  bool can_begin_map() const;
  bool start_map();
  void restart_map();
  bool map_is_worthless(bool tracked);
  void begin_again();
  bool track_frame();
  bool track_from_last();
  int match_last(const Rigid3& T_camera_world, float radius_px);
  bool track_local_map(const Rigid3& T_camera_world, float widening);
  PoseSolution match_local_map(const Rigid3& T_camera_world, float widening, double gate);
  void observe_matches();
  int refine_matches(const PoseSolution& solution);
  void take_landmarks();
  void learn_noise(const PoseSolution& solution);
  void compensate_shutter();
  void accept(const PoseSolution& solution);
  bool relocalise();
  bool found_near();
  bool found_at_start();
  bool far_better_elsewhere();
  bool found_anywhere();
  bool confirm(const Rigid3& T_camera_world);
  bool hangs_on_one_thing();
  bool moved_possibly() const;
  void hold_pose();
  void update_state(bool tracked);
  void upkeep();
  void name_reference();
  void apply_answers();
  void ask_for_smoothing();
  void move_with_map(const Rigid3& T_new_old);
  void forget_dead_landmarks();
  MapMeta meta() const;

  PinholeCamera camera_;
  double rolling_shutter_s_;
  FrontendOptions options_;
  Rigid3 T_world_camera_start_;
  FrameBuilder builder_;
  Map map_;
  LocalMap local_map_;
  LandmarkSearch search_;
  Matcher matcher_;
  MotionModel motion_;
  TurnPrior turn_prior_;
  PatchRefiner refiner_;
  NoiseScale depth_noise_;
  Keyframer keyframer_;
  Relocaliser relocaliser_;
  SmoothExchange smooth_exchange_;
  MapJournal journal_;
  MapPlaces places_;
  LoopCloser loops_;
  std::unordered_map<std::int64_t, std::int32_t> restored_landmarks_;  // id -> slot, of an earlier session
  ThingCount things_{256};                                             // in a frame
  Agreement agreement_;                                                // of what frames say while lost
  ObjectWishes wishes_;
  Frame frame_, last_;
  std::vector<PoseObservation> observations_;
  std::vector<std::int32_t> observed_feature_;  // of each observation
  TrackResult result_;

  std::int64_t frame_index_ = 0;
  std::int32_t newest_keyframe_ = kNone;
  std::int64_t reference_id_ = -1;
  int matches_of_last_ = 0;  // points of the frame before last that the last one showed
  int good_frames_ = 0, bad_frames_ = 0;
  bool regaining_ = false;    // a pose was held or found anew, and trust is not back yet
  double unseen_s_ = 0.0;     // since the last tracked frame, while none is
  double fruitless_s_ = 0.0;  // of frames in a row that showed enough for a map and were not found in ours
  int start_tries_ = 0;       // frames in which the start pose may still be tried on an earlier session's map

  SmoothProblem problem_;
  enum class ProblemState { idle, offered, out, answered } problem_state_ = ProblemState::idle;
  bool problem_outdated_ = false;  // the map was corrected since it was cut
};

}  // namespace povslam
