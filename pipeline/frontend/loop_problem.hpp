// A loop to be closed as plain values: what the frontend asks, what the backend answers. Filled on the tracking thread,
// solved in place beside it, handed back.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/geometry/rigid.hpp"

namespace povslam {

struct LoopProblem {
  struct Pose {
    Rigid3 T_world_camera;
    std::int64_t keyframe = -1;  // id
    bool fixed = false;
  };
  // Says where `to` stands in the axes of `from`. Errors in the tangent space of the relative motion (see Rigid3).
  struct Edge {
    std::int32_t from = 0, to = 0;  // indices into poses
    Rigid3 T_from_to;
    double sigma_m = 0.01, sigma_rad = 0.005;  // one standard deviation per axis
    bool loop = false;                         // found by recognising a place; all others are what tracking knew
  };
  std::vector<Pose> poses;
  std::vector<Edge> edges;
  std::int64_t asked_at_frame = 0;

  // Answer.
  bool converged = false;  // the poses may be used
  int iterations = 0;
  double cost_before = 0.0, cost_after = 0.0;       // 1/2 sum of robust squared whitened residuals
  double loop_error_m = 0.0, loop_error_rad = 0.0;  // of the worst loop edge, afterwards
  double strain = 0.0;                              // greatest whitened residual norm among the other edges, afterwards

  void clear() {
    poses.clear();
    edges.clear();
    converged = false;
    iterations = 0;
    cost_before = cost_after = loop_error_m = loop_error_rad = strain = 0.0;
  }
};

}  // namespace povslam
