// Finding the camera in the map without a prediction: descriptors against one keyframe's landmarks, then RANSAC over
// three 3-D to 3-D pairs, then the robust pose. Bounded work a call, no allocation after construction.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/frontend/map.hpp"
#include "pipeline/frontend/solve_pose.hpp"

namespace povslam {

class Relocaliser {
 public:
  Relocaliser(const PinholeCamera& camera, const FrontendOptions& options);

  struct Found {
    Rigid3 T_camera_world;
    int num_inliers = 0;
  };
  // Tries one keyframe.
  std::optional<Found> against(const Map& map, std::int32_t keyframe, const Frame& frame);

 private:
  struct Pair {
    std::int32_t feature;
    Eigen::Vector3d p_camera;  // zero without depth
    Eigen::Vector3d p_world;
    bool has_depth;
  };
  void collect_pairs(const Map& map, std::int32_t keyframe, const Frame& frame);
  std::optional<Rigid3> best_of_triples(const Frame& frame) const;
  int count_inliers(const Frame& frame, const Rigid3& T_camera_world) const;

  PinholeCamera camera_;
  std::vector<Pair> pairs_;
  std::vector<std::int32_t> pair_of_feature_;
  std::vector<std::int32_t> distance_of_feature_;
  std::vector<PoseObservation> observations_;
};

}  // namespace povslam
