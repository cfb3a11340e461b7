// The journey of a frame: localise (each frame, tracking thread), then what is done beside it.
// No threads, files or clocks of its own: the daemon and `povslam replay` run the same object.
//
//   Pipeline pipeline(options, calibration, T_world_body_start);
//   for each frame:  publish(pipeline.localise(frame));
//                    if (SmoothProblem* problem = pipeline.take_problem()) …solve it beside tracking with smooth()…
//                    …once solved, before a later localise(): pipeline.give_back(problem);
#pragma once

#include <memory>
#include <optional>

#include "pipeline/frames/calibration.hpp"
#include "pipeline/frames/rgbd_frame.hpp"
#include "pipeline/frontend/smooth_problem.hpp"
#include "pipeline/options.hpp"
#include "pipeline/output.hpp"

namespace povslam {

class Pipeline {
 public:
  // T_world_body_start: where the body is at the first frame (world is level there; a dock pose or the origin).
  Pipeline(const PipelineOptions& options, const SensorCalibration& calibration, const Rigid3& T_world_body_start);
  ~Pipeline();

  // Tracks one frame. After warm-up neither allocates nor locks. The result is valid until the next call.
  const PoseEstimate& localise(const RgbdFrame& frame);

  // After localise(): a bundle adjustment to solve beside tracking, or null. The problem stays the pipeline's; the
  // caller may hand it to another thread and must give it back, solved or not, between two calls of localise().
  SmoothProblem* take_problem();
  void give_back(SmoothProblem* problem);

  // Present pose of a keyframe named by a PoseEstimate (also of one merged away since), T_world_camera.
  std::optional<Rigid3> keyframe_pose(std::int64_t keyframe) const;
  MapSize map_size() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace povslam
