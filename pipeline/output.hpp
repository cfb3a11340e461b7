// What leaves the pipeline each frame.
#pragma once

#include <cstdint>

#include "pipeline/base/time.hpp"
#include "pipeline/frontend/loop_counts.hpp"
#include "pipeline/frontend/track_state.hpp"
#include "pipeline/geometry/rigid.hpp"

namespace povslam {

struct StageTimes {  // CPU of the calling thread [ms]
  float features_ms = 0.0F;
  float track_ms = 0.0F;     // matching and pose
  float keyframe_ms = 0.0F;  // map upkeep, only when a keyframe was made or an answer came in
  float total_ms = 0.0F;
};

struct PoseEstimate {
  TimeNs stamp = 0;
  std::uint64_t seq = 0;  // the frame's
  TrackState state = TrackState::initialising;
  Rigid3 T_world_camera;
  Rigid3 T_world_body;
  Rigid3 T_odom_body;                      // continuous (REP-105): never jumps when the map is corrected
  Matrix6d covariance = Matrix6d::Zero();  // of T_world_body: (x, y, z, rot_x, rot_y, rot_z), world axes (see Rigid3)
  std::uint32_t map_version = 0;  // grows with every jump of T_world_*: a loop was closed, a lost robot found itself
  int num_features = 0;
  int num_landmarks = 0;  // matched and fitting
  bool keyframe = false;
  std::int64_t reference_keyframe = -1;  // Pipeline::keyframe_pose(reference) * T_reference_camera: the corrected pose
  Rigid3 T_reference_camera;
  StageTimes times;
};

struct MapSize {
  int keyframes = 0;
  int landmarks = 0;
};

}  // namespace povslam
