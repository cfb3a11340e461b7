// Poses of a trajectory by the stamp of a frame.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "drivers/replay/trajectory_file.hpp"

namespace povslam {

class TruePoses {
 public:
  explicit TruePoses(std::vector<StampedPose> poses) : poses_(std::move(poses)) {}
  bool empty() const { return poses_.empty(); }

  // Between its neighbours, if they are no further apart than 0.1 s; nothing outside.
  std::optional<Rigid3> at(TimeNs stamp) const {
    constexpr TimeNs kLongest = 100 * kNsPerMs;
    const auto after = std::lower_bound(poses_.begin(), poses_.end(), stamp,
                                        [](const StampedPose& pose, TimeNs t) { return pose.stamp < t; });
    if (after == poses_.end()) return std::nullopt;
    if (after->stamp == stamp) return after->T_world_sensor;
    if (after == poses_.begin() || after->stamp - std::prev(after)->stamp > kLongest) return std::nullopt;
    const StampedPose& before = *std::prev(after);
    return interpolate(before.T_world_sensor, after->T_world_sensor,
                       to_seconds(stamp - before.stamp) / to_seconds(after->stamp - before.stamp));
  }

 private:
  std::vector<StampedPose> poses_;
};

}  // namespace povslam
