// Cuts the pose graph of a recognised loop out of the map and brings its answer back in, while tracking went on
// meanwhile.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/frontend/loop_problem.hpp"
#include "pipeline/frontend/map.hpp"
#include "pipeline/frontend/map_motion.hpp"

namespace povslam {

// A place recognised: keyframe `now` sees what `then` saw.
struct LoopFound {
  std::int64_t now = -1, then = -1;  // keyframe ids
  Rigid3 T_then_now;                 // camera of now in the axes of then's camera
  int num_inliers = 0;
};

class LoopExchange {
 public:
  explicit LoopExchange(const MapOptions& options);

  // All keyframes; edges between those that see the same, and the loop. False: one of the two is gone, or nothing is
  // there to move. May allocate: a loop is rare.
  bool cut(const Map& map, const LoopFound& found, std::int64_t frame_index, LoopProblem& problem);
  // Keyframes move by what the answer moved them, with all that hangs on them. Nullopt: the answer is none; else how
  // the keyframe `follow` was moved, T_new * T_old^-1 in the world.
  std::optional<Rigid3> apply(Map& map, const LoopProblem& problem, std::int64_t follow_id);

 private:
  void add_edges(const Map& map, LoopProblem& problem) const;
  static void join_parts(LoopProblem& problem);

  std::vector<std::int32_t> pose_of_keyframe_;  // by keyframe slot: index in the problem, or -1
  std::vector<Rigid3> T_world_camera_asked_;    // as the poses were when cut
  MapMotion motion_;
};

}  // namespace povslam
