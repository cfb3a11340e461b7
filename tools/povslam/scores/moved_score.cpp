#include "tools/povslam/scores/moved_score.hpp"

#include <algorithm>
#include <numbers>

#include "tools/povslam/scores/matching.hpp"

namespace povslam::scores {
namespace {

double horizontal_distance(const OrientedBox& a, const OrientedBox& b) {
  return (a.center_world - b.center_world).head<2>().norm();
}

// Turned by a quarter and its edges exchanged, a box is the same box.
double yaw_error(const OrientedBox& truth, const OrientedBox& said) {
  const double half = yaw_difference_mod_half_turn(truth.yaw_rad, said.yaw_rad);
  return std::min(half, std::numbers::pi / 2.0 - half);
}

double edge_error(const OrientedBox& truth, const OrientedBox& said) {
  const Eigen::Vector2d edges_m = truth.size_m.head<2>(), said_m = said.size_m.head<2>();
  return std::min((edges_m - said_m).cwiseAbs().maxCoeff(), (edges_m - said_m.reverse()).cwiseAbs().maxCoeff());
}

bool has_moved(const TrueObject& object) {
  return object.changed && object.before && object.after;
}

MovedBox compare(const TrueObject& truth, const ReportedEvent& event, std::span<const ReportedObject> objects,
                 double max_distance_m) {
  MovedBox moved;
  moved.object = event.object;
  moved.truth = truth.id;
  moved.distance_m = horizontal_distance(*truth.after, event.box);
  moved.yaw_rad = yaw_error(*truth.after, event.box);
  moved.edge_error_m = edge_error(*truth.after, event.box);
  moved.same_thing = event.from && horizontal_distance(*truth.before, *event.from) <= max_distance_m;
  const auto now = std::find_if(objects.begin(), objects.end(),
                                [&](const ReportedObject& object) { return object.id == event.object; });
  if (event.object >= 0 && now != objects.end()) {
    moved.end_distance_m = horizontal_distance(*truth.after, now->box);
    moved.end_edge_error_m = edge_error(*truth.after, now->box);
  }
  return moved;
}

}  // namespace

std::vector<MovedBox> score_moved(const SceneTruth& truth, std::span<const ReportedEvent> events,
                                  std::span<const ReportedObject> objects, double max_distance_m) {
  std::vector<MatchedPair> candidates;
  for (std::size_t i = 0; i < truth.objects.size(); ++i) {
    if (!has_moved(truth.objects[i])) continue;
    for (std::size_t j = 0; j < events.size(); ++j) {
      if (events[j].type != EventType::moved) continue;
      const double distance_m = horizontal_distance(*truth.objects[i].after, events[j].box);
      if (distance_m <= max_distance_m) candidates.push_back({i, j, distance_m});
    }
  }
  std::vector<MovedBox> moved;
  for (const MatchedPair& pair : match_one_to_one(candidates, truth.objects.size(), events.size())) {
    moved.push_back(compare(truth.objects[pair.truth], events[pair.reported], objects, max_distance_m));
  }
  return moved;
}

}  // namespace povslam::scores
