// A frame chosen to be understood: what it measured, where it was taken, which landmarks it saw.
#pragma once

#include <vector>

#include "pipeline/frames/rgbd_frame.hpp"
#include "pipeline/geometry/rigid.hpp"
#include "pipeline/objects/class_table.hpp"
#include "pipeline/objects/keyframe_motion.hpp"
#include "pipeline/objects/object_event.hpp"

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
  std::vector<std::int64_t> doubted;  // objects that are seen and not believed to be where they were

  TimeNs stamp() const { return frame.stamp; }
};

// Which object a landmark of the tracker belongs to: the tracker's own table keeps it.
struct LandmarkOwner {
  static constexpr std::int64_t kStructure = 0;  // floor, walls, racks; ids of objects are greater
  static constexpr std::int64_t kNobody = -1;    // not known
  static constexpr std::int64_t kGone = -2;      // of something that is not there any more, or moves while one looks
  std::int64_t landmark = -1;
  std::int32_t slot = -1;  // see SeenLandmark; -1: an earlier session's landmark, not seen in this one
  std::int64_t object = kNobody;
  TimeNs seen = 0;  // stamp of the view that told it; 0: known from before the session
};

// What tracking is told of an object: where it stands and what is believed of that.
struct ObjectBelief {
  std::int64_t object = -1;
  ObjectPlace place;
  Belief belief;
  ClassKind kind = ClassKind::semi_static;
  double k_inlier = 0.0, k_outlier = 3.0;  // of its class, see ObjectClass
  bool gone = false;                       // it is not in the library any more
  TimeNs seen = 0;                         // stamp of the view that told it; 0: known from before the session
};

}  // namespace povslam
