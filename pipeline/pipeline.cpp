#include "pipeline/pipeline.hpp"

#include <utility>

#include "pipeline/frontend/track.hpp"
#include "pipeline/held_news.hpp"
#include "pipeline/jobs_out.hpp"
#include "pipeline/keyframe_anchors.hpp"

namespace povslam {

namespace {
constexpr int kMostOwners = 8192, kMostBeliefs = 512;  // held at once; what is more enters sooner
}  // namespace

struct Pipeline::Impl {
  Impl(const PipelineOptions& options, const SensorCalibration& calibration, const Rigid3& T_world_body_start,
       const MapContent* map)
      : T_camera_body(calibration.T_body_sensor.inverse()),
        tracker(calibration, options.frontend, T_world_body_start * calibration.T_body_sensor, map),
        delay_frames(options.backend.delay_frames),
        window_delay_frames(options.window.delay_frames),
        pov(options.mode == "pov"),
        vem(calibration.camera, options.frontend, options.window, options.understanding.objects.belief),
        owners(from_seconds(options.understanding.answer_delay_s), kMostOwners),
        beliefs(from_seconds(options.understanding.answer_delay_s), kMostBeliefs),
        view_period(from_seconds(options.understanding.period_s)) {
    T_odom_start = T_world_body_start * calibration.T_body_sensor;
  }

  // A list of motions is made only when the map jumped, which is rare.
  void hang(View& view) {
    view.corrections.clear();
    const auto pose_of = [this](std::int64_t keyframe) { return tracker.map().keyframe_pose(keyframe); };
    if (std::exchange(anchors_version, view.map_version) != view.map_version) {
      anchors.collect(pose_of, view.corrections);
    }
    if (const auto T_world_keyframe = pose_of(view.reference_keyframe)) {
      anchors.hang_on(view.reference_keyframe, *T_world_keyframe);
    }
  }

  // Answers that are due enter.
  void enter_answers() {
    while (const auto job = jobs.take_due(next_frame)) {
      if (VemProblem* const* window = std::get_if<VemProblem*>(&*job)) vem.give_back(*window);
      if (SmoothProblem* const* problem = std::get_if<SmoothProblem*>(&*job)) tracker.give_back(*problem);
      if (LoopProblem* const* problem = std::get_if<LoopProblem*>(&*job)) tracker.give_back(*problem);
    }
  }
  std::optional<BackendJob> hand_out(const BackendJob& job) {
    const bool window = std::holds_alternative<VemProblem*>(job);
    jobs.add(job, next_frame - 1 + (window ? window_delay_frames : delay_frames));
    return job;
  }

  void own(std::span<const LandmarkOwner> told) {
    gone.clear();
    for (const LandmarkOwner& owner : told) {
      if (owner.object == LandmarkOwner::kGone) {
        gone.emplace_back(owner.slot, owner.landmark);
      } else {
        tracker.set_owner(owner.slot, owner.landmark, owner.object);
      }
    }
    if (!gone.empty()) tracker.remove_landmarks(gone);
  }
  void believe(std::span<const ObjectBelief> told) {
    for (const ObjectBelief& belief : told) vem.know(belief, tracker.object_trust());
  }
  void enter_owners(std::span<const LandmarkOwner> told) {
    own(told);
    owners.drop(told.size());
  }
  void enter_beliefs(std::span<const ObjectBelief> told) {
    believe(told);
    beliefs.drop(told.size());
  }

  // What is known of objects by the time of the frame just tracked enters; after its pose has left, for it may
  // allocate.
  void enter_news() {
    enter_owners(owners.due(estimate.stamp));
    enter_beliefs(beliefs.due(estimate.stamp));
  }
  // What came of it enters.
  void apply_window() {
    if (!pov) return;
    if (const auto T_new_old = vem.apply(tracker.object_trust())) tracker.correct(*T_new_old);
  }
  // The frame tracked just now into the window.
  void look(const RgbdFrame& frame, const TrackResult& track) {
    if (!pov) return;
    if (track.map_version != map_version) vem.map_moved();
    map_version = track.map_version;
    const bool tracked = track.state == TrackState::ok || track.state == TrackState::degraded;
    if (!tracked || track.num_landmarks == 0) return vem.forget();
    vem.look(tracker.map(), tracker.local_map(), frame, tracker.frame(), track.T_odom_camera);
  }

  Rigid3 T_camera_body;
  Rigid3 T_odom_start;  // odom begins where the world does
  Tracker tracker;
  JobsOut jobs{4};  // one of each kind can be out
  int delay_frames, window_delay_frames;
  std::int64_t next_frame = 0;  // index of the one that localise() is given next
  PoseEstimate estimate;
  bool pov;
  VemExchange vem;
  std::uint32_t map_version = 0;
  HeldNews<LandmarkOwner> owners;
  HeldNews<ObjectBelief> beliefs;
  std::vector<std::pair<std::int32_t, std::int64_t>> gone;
  TimeNs view_period;
  std::optional<TimeNs> last_view;
  KeyframeAnchors anchors;
  std::uint32_t anchors_version = 0;  // of the map, when they were last compared with it
};

Pipeline::Pipeline(const PipelineOptions& options, const SensorCalibration& calibration,
                   const Rigid3& T_world_body_start, const MapContent* map)
    : impl_(std::make_unique<Impl>(options, calibration, T_world_body_start, map)) {}
Pipeline::~Pipeline() = default;

namespace {

// The camera's covariance carried to the body, which sits at p_camera_body in the camera: its place moves with the
// turn.
Matrix6d covariance_of_body(const Matrix6d& covariance, const Rigid3& T_world_camera, const Rigid3& T_camera_body) {
  Matrix6d J = Matrix6d::Identity();
  J.topRightCorner<3, 3>() = -skew(T_world_camera.rotation * T_camera_body.translation);
  return J * covariance * J.transpose();
}

float ms(TimeNs span) {
  return static_cast<float>(to_ms(span));
}

}  // namespace

const PoseEstimate& Pipeline::localise(const RgbdFrame& frame) {
  const TimeNs start = thread_cpu_now();
  impl_->enter_answers();
  ++impl_->next_frame;
  impl_->apply_window();
  const TrackResult& track = impl_->tracker.track(frame);
  PoseEstimate& out = impl_->estimate;
  out.stamp = frame.stamp;
  out.seq = frame.seq;
  out.state = track.state;
  out.T_world_camera = track.T_world_camera;
  out.T_world_body = track.T_world_camera * impl_->T_camera_body;
  out.T_odom_body = impl_->T_odom_start * track.T_odom_camera * impl_->T_camera_body;
  out.covariance = covariance_of_body(track.covariance, track.T_world_camera, impl_->T_camera_body);
  out.map_version = track.map_version;
  out.num_features = track.num_features;
  out.num_landmarks = track.num_landmarks;
  out.keyframe = track.keyframe;
  out.reference_keyframe = track.reference_keyframe;
  out.T_reference_camera = track.T_reference_camera;
  impl_->look(frame, track);
  out.times = {ms(track.features_ns), ms(track.track_ns), ms(track.keyframe_ns), ms(thread_cpu_now() - start)};
  return out;
}

std::optional<BackendJob> Pipeline::take_job() {
  impl_->enter_news();
  if (impl_->pov) {
    if (VemProblem* window = impl_->vem.take(impl_->tracker.map())) return impl_->hand_out(window);
  }
  if (LoopProblem* loop = impl_->tracker.take_loop()) return impl_->hand_out(loop);
  if (SmoothProblem* window = impl_->tracker.take_problem()) return impl_->hand_out(window);
  return std::nullopt;
}
void Pipeline::give_back(const BackendJob& job) {
  impl_->jobs.answer(job);
}

MapChange* Pipeline::take_change() {
  return impl_->tracker.take_change();
}
MapChange* Pipeline::collect_change() {
  return impl_->tracker.collect_change();
}
void Pipeline::give_back(MapChange* change) {
  impl_->tracker.give_back(change);
}

bool Pipeline::view_due() const {
  const PoseEstimate& pose = impl_->estimate;
  if (pose.state != TrackState::ok && pose.state != TrackState::degraded) return false;
  constexpr TimeNs kJitter = 5 * kNsPerMs;  // of frame stamps about their period
  return !impl_->last_view || pose.stamp - *impl_->last_view >= impl_->view_period - kJitter;
}

void Pipeline::fill_view(const RgbdFrame& frame, View& view) {
  const PoseEstimate& pose = impl_->estimate;
  EXPECTS(frame.stamp == pose.stamp);
  impl_->last_view = frame.stamp;
  view.frame = frame;
  view.T_world_camera = pose.T_world_camera;
  view.covariance = pose.covariance;
  view.trusted = pose.state == TrackState::ok;
  view.map_version = pose.map_version;
  view.reference_keyframe = pose.reference_keyframe;
  impl_->hang(view);
  view.landmarks.clear();
  view.doubted.clear();
  if (impl_->pov) impl_->vem.doubted(view.doubted);
  const Frame& seen = impl_->tracker.frame();
  const Map& map = impl_->tracker.map();
  for (int i = 0; i < seen.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (seen.landmark[k] == kNone) continue;
    const Landmark& landmark = map.landmark(seen.landmark[k]);
    view.landmarks.push_back(
        {landmark.id, seen.landmark[k], seen.x[k], seen.y[k], seen.inverse_depth[k], landmark.p_world});
  }
}

void Pipeline::take_owners(std::span<const LandmarkOwner> owners) {
  if (!impl_->pov || owners.empty()) return;
  if (owners.front().seen != 0 && impl_->owners.add(owners)) return;
  impl_->enter_owners(impl_->owners.all());
  impl_->own(owners);
}

void Pipeline::take_beliefs(std::span<const ObjectBelief> beliefs) {
  if (!impl_->pov || beliefs.empty()) return;
  if (beliefs.front().seen != 0 && impl_->beliefs.add(beliefs)) return;
  impl_->enter_beliefs(impl_->beliefs.all());
  impl_->believe(beliefs);
}

void Pipeline::take_restored(const Understanding& understanding) {
  std::vector<LandmarkOwner> owners;
  std::vector<ObjectBelief> beliefs;
  understanding.tell_restored(owners, beliefs);
  take_owners(owners);
  take_beliefs(beliefs);
}

std::optional<Rigid3> Pipeline::keyframe_pose(std::int64_t keyframe) const {
  return impl_->tracker.map().keyframe_pose(keyframe);
}
MapSize Pipeline::map_size() const {
  return {impl_->tracker.map().num_keyframes(), impl_->tracker.map().num_landmarks()};
}

VemCounts Pipeline::vem() const {
  return impl_->vem.counts();
}

LoopCounts Pipeline::loops() const {
  return impl_->tracker.loops();
}

}  // namespace povslam
