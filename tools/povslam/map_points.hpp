// Where a stored map's landmarks lie in the world: each hangs on its anchor.
#pragma once

#include <Eigen/Core>
#include <map>
#include <unordered_map>

#include "daemon/store.hpp"

namespace povslam {

class MapPoints {
 public:
  explicit MapPoints(const MapContent& map) {
    std::unordered_map<std::int64_t, const Rigid3*> pose_of;
    for (const KeyframeRow& row : map.keyframes) pose_of[row.keyframe] = &row.T_world_camera;
    for (const LandmarkRow& row : map.landmarks) {
      const auto anchor = pose_of.find(row.anchor);
      if (anchor != pose_of.end()) p_world_[row.landmark] = *anchor->second * row.p_anchor;
    }
  }
  const Eigen::Vector3d* find(std::int64_t landmark) const {
    const auto found = p_world_.find(landmark);
    return found == p_world_.end() ? nullptr : &found->second;
  }
  const std::map<std::int64_t, Eigen::Vector3d>& all() const { return p_world_; }  // by id

 private:
  std::map<std::int64_t, Eigen::Vector3d> p_world_;
};

}  // namespace povslam
