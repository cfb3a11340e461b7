#include "pipeline/pipeline.hpp"

#include "pipeline/frontend/track.hpp"

namespace povslam {

struct Pipeline::Impl {
  Impl(const PipelineOptions& options, const SensorCalibration& calibration, const Rigid3& T_world_body_start,
       const MapContent* map)
      : T_camera_body(calibration.T_body_sensor.inverse()),
        tracker(calibration, options.frontend, T_world_body_start * calibration.T_body_sensor, map) {
    T_odom_start = T_world_body_start * calibration.T_body_sensor;
  }

  Rigid3 T_camera_body;
  Rigid3 T_odom_start;  // odom begins where the world does
  Tracker tracker;
  PoseEstimate estimate;
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
  out.times = {ms(track.features_ns), ms(track.track_ns), ms(track.keyframe_ns), ms(thread_cpu_now() - start)};
  return out;
}

std::optional<BackendJob> Pipeline::take_job() {
  if (LoopProblem* loop = impl_->tracker.take_loop()) return loop;
  if (SmoothProblem* window = impl_->tracker.take_problem()) return window;
  return std::nullopt;
}
void Pipeline::give_back(const BackendJob& job) {
  std::visit([this](auto* problem) { impl_->tracker.give_back(problem); }, job);
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

std::optional<Rigid3> Pipeline::keyframe_pose(std::int64_t keyframe) const {
  return impl_->tracker.map().keyframe_pose(keyframe);
}
MapSize Pipeline::map_size() const {
  return {impl_->tracker.map().num_keyframes(), impl_->tracker.map().num_landmarks()};
}

LoopCounts Pipeline::loops() const {
  return impl_->tracker.loops();
}

}  // namespace povslam
