// Constant velocity between frames: predicts the next pose, and how the camera moved while a frame was read out.
#pragma once

#include "pipeline/base/time.hpp"
#include "pipeline/geometry/rigid.hpp"

namespace povslam {

class MotionModel {
 public:
  // A frame was tracked dt after the previous one. T_before_now: the camera's motion in between.
  void moved(const Rigid3& T_before_now, TimeNs dt);
  void forget();  // after a frame without a pose
  bool known() const { return known_; }

  Rigid3 predict(TimeNs dt) const;  // T_before_now over the coming dt, identity if not known
  // Speed at the end of a motion, (m/s, rad/s) in the camera's own axes: its mean, and half the change since the last
  // one.
  Vector6d speed_after(const Rigid3& T_before_now, TimeNs dt) const;

 private:
  Vector6d mean_speed_ = Vector6d::Zero();  // over the last motion
  bool known_ = false;
};

}  // namespace povslam
