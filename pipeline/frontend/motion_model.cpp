#include "pipeline/frontend/motion_model.hpp"

#include <algorithm>

namespace povslam {

namespace {
constexpr double kLongestPredictedS = 0.5;  // after a longer gap the old speed says nothing
}

void MotionModel::moved(const Rigid3& T_before_now, TimeNs dt) {
  known_ = dt > 0;
  if (known_) mean_speed_ = se3_log(T_before_now) / to_seconds(dt);
}

void MotionModel::forget() {
  known_ = false;
  mean_speed_.setZero();
}

Rigid3 MotionModel::predict(TimeNs dt) const {
  if (!known_) return Rigid3{};
  return se3_exp(std::clamp(to_seconds(dt), 0.0, kLongestPredictedS) * mean_speed_);
}

Vector6d MotionModel::speed_after(const Rigid3& T_before_now, TimeNs dt) const {
  if (!known_ || dt <= 0) return Vector6d::Zero();
  const Vector6d mean = se3_log(T_before_now) / to_seconds(dt);
  return mean + 0.5 * (mean - mean_speed_);
}

}  // namespace povslam
