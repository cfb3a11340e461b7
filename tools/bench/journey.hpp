// The pipeline driven frame by frame in one thread, as `povslam replay` does it.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pipeline/pipeline.hpp"

namespace povslam {

class Journey {
 public:
  Journey(const PipelineOptions& options, const SensorCalibration& calibration, const Rigid3& T_world_body_start,
          const MapContent* map = nullptr)
      : backend_(options.backend), pipeline_(options, calibration, T_world_body_start, map) {}

  const PoseEstimate& track(const RgbdFrame& frame) {
    const PoseEstimate& pose = pipeline_.localise(frame);
    while (const auto job = pipeline_.take_job()) {
      solve(*job, backend_);
      pipeline_.give_back(*job);
    }
    return pose;
  }

  // The map as an earlier session leaves it behind. Changes must not have been taken.
  MapContent content() {
    MapChange* whole = pipeline_.collect_change();
    if (whole == nullptr) return {};
    MapContent map = *whole;
    map.removed_keyframes.clear();
    map.removed_landmarks.clear();
    pipeline_.give_back(whole);
    return map;
  }

  const Pipeline& pipeline() const { return pipeline_; }

 private:
  BackendOptions backend_;
  Pipeline pipeline_;
};

inline bool has_pose(const PoseEstimate& pose) {
  return pose.state == TrackState::ok || pose.state == TrackState::degraded;
}

struct PoseError {
  double m = 0.0, deg = 0.0;
  bool wrong() const { return !(m <= 0.3 && deg <= 5.0); }  // numbers that are none are wrong
};
inline PoseError error_of(const Rigid3& estimate, const Rigid3& truth) {
  constexpr double kDegrees = 57.29577951308232;
  return {(estimate.translation - truth.translation).norm(),
          kDegrees * so3_log(truth.rotation.conjugate() * estimate.rotation).norm()};
}

// Nearest rank; 0 of nothing.
template <class Number>
Number quantile(std::vector<Number> values, double share) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  return values[std::max<std::size_t>(rank, 1) - 1];
}

}  // namespace povslam
