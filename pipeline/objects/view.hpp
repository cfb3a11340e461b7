// A frame chosen to be understood: what it measured, where it was taken, which landmarks it saw.
#pragma once

#include <vector>

#include "pipeline/frames/rgbd_frame.hpp"
#include "pipeline/geometry/rigid.hpp"
#include "pipeline/objects/keyframe_motion.hpp"

namespace povslam {

struct SeenLandmark {
  std::int64_t landmark = -1;                         // id of the tracker's map…
  std::int32_t slot = -1;                             // …and where that keeps it at present
  float x = 0.0F, y = 0.0F;                           // px, rectified
  float inverse_depth = 0.0F;                         // 1/m, measured; 0 = none
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();  // where the map has it
};

struct View {
  RgbdFrame frame;
  Rigid3 T_world_camera;
  Matrix6d covariance = Matrix6d::Zero();  // of T_world_camera (see Rigid3)
  bool trusted = false;                    // the tracker's state was OK
  std::uint32_t map_version = 0;
  std::int64_t reference_keyframe = -1;  // that its pose hangs on; -1: on none, it will never be corrected
  // Keyframes that earlier views hung on and that were moved since the view before, by ascending keyframe: this view's
  // pose is one of the corrected map, theirs are not.
  std::vector<KeyframeMotion> corrections;
  std::vector<SeenLandmark> landmarks;

  TimeNs stamp() const { return frame.stamp; }
};

// Which object a landmark of the tracker belongs to: the tracker's own table keeps it.
struct LandmarkOwner {
  std::int64_t landmark = -1;
  std::int32_t slot = -1;    // see SeenLandmark
  std::int64_t object = -1;  // -1: none
};

}  // namespace povslam
