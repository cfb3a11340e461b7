// Where moved boxes were said to stand now, against where they truly stand.
//
// Each reported move is paired with the object of the truth that changed its place and now stands nearest to the
// reported new place, one-to-one, within max_distance_m horizontally.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tools/povslam/scores/scene_files.hpp"

namespace povslam::scores {

struct MovedBox {
  int object = -1;          // of the run
  int truth = -1;           // id of the true object
  double distance_m = 0.0;  // between the centres, horizontally, as told with the event
  double yaw_rad = 0.0;     // of the sides: modulo a quarter turn
  bool same_thing = false;  // its old place is that of the same true object, within max_distance_m
  // By how much an edge of the footprint is longer or shorter than the true one, the worse of the two: where a side was
  // not seen yet, the box ends too early, and its centre is off by half of what is missing.
  double edge_error_m = 0.0;
  std::optional<double> end_edge_error_m;
  std::optional<double> end_distance_m;  // of the library's object at the end of the run, if it is still there
};

// Both in the truth's world. By truth's index.
std::vector<MovedBox> score_moved(const SceneTruth& truth, std::span<const ReportedEvent> events,
                                  std::span<const ReportedObject> objects, double max_distance_m);

}  // namespace povslam::scores
