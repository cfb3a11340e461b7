// Cuts a local bundle adjustment out of the map and brings its answer back in, while tracking went on meanwhile.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/frontend/map.hpp"
#include "pipeline/frontend/map_motion.hpp"
#include "pipeline/frontend/smooth_problem.hpp"
#include "pipeline/geometry/camera.hpp"

namespace povslam {

class SmoothExchange {
 public:
  SmoothExchange(const PinholeCamera& camera, const FrontendOptions& options);

  void reserve(SmoothProblem& problem) const;  // once, before its first use
  // The keyframe and those most covisible with it move; others that see the same landmarks hold still.
  // look_sigma_px: of a place found by fitting a landmark's first look, on pyramid level 0.
  // False (problem empty) when there is nothing to smooth yet.
  bool cut(Map& map, std::int32_t keyframe, std::int64_t frame_index, double look_sigma_px, SmoothProblem& problem);
  // What was removed meanwhile is skipped, what was added meanwhile moves along with what it hangs on.
  // Returns how the keyframe `follow` was moved: T_new * T_old^-1 in the world (identity if it was not).
  Rigid3 apply(Map& map, const SmoothProblem& problem, std::int64_t follow_id);

 private:
  void add_pose(Map& map, std::int32_t slot, bool fixed, SmoothProblem& problem);
  void add_points(Map& map, std::size_t first_pose, std::size_t last_pose, SmoothProblem& problem);
  void add_fixed_poses(Map& map, SmoothProblem& problem);
  void add_observations(const Map& map, SmoothProblem& problem);
  float sigma_px(const Map& map, const Landmark& point, const LandmarkSighting& sighting) const;
  void move_keyframes(Map& map, const SmoothProblem& problem);
  void drop_outliers(Map& map, const SmoothProblem& problem);

  PinholeCamera camera_;
  MapOptions options_;
  std::vector<std::int32_t> pose_of_keyframe_;   // by keyframe slot: index in the problem, or -1
  std::vector<std::int32_t> point_of_landmark_;  // by landmark slot
  MapMotion motion_;
  float look_sigma_px_ = 1.0F;  // of the problem that is being cut
};

}  // namespace povslam
