#include "tools/povslam/scores/event_score.hpp"

#include <utility>

#include "tools/povslam/scores/join.hpp"

namespace povslam::scores {
namespace {

double horizontal_distance(const OrientedBox& a, const OrientedBox& b) {
  return (a.center_world - b.center_world).head<2>().norm();
}

}  // namespace

std::vector<PlaceChange> changes_of(std::span<const ReportedEvent> events) {
  std::vector<PlaceChange> changes;
  for (const ReportedEvent& event : events) {
    if (event.type == EventType::removed) changes.push_back({Fate::gone, event.class_name, event.box});
    if (event.from) changes.push_back({Fate::gone, event.class_name, *event.from});
    if (event.type != EventType::removed) changes.push_back({Fate::came, event.class_name, event.box});
  }
  return changes;
}

std::vector<PlaceChange> join_touching(std::vector<PlaceChange> changes, double gap_m) {
  return join_where(std::move(changes), [gap_m](const PlaceChange& a, const PlaceChange& b) {
    return a.fate == b.fate && a.class_name == b.class_name && boxes_touch(a.box, b.box, gap_m);
  });
}

Verdict score_events(std::span<const PlaceChange> truth, std::span<const PlaceChange> reported, double max_distance_m) {
  std::vector<char> required;
  for (const PlaceChange& change : truth) required.push_back(change.required ? 1 : 0);
  return judge(required, reported.size(), [&](std::size_t i, std::size_t j) -> std::optional<double> {
    const double distance_m = horizontal_distance(truth[i].box, reported[j].box);
    if (truth[i].fate != reported[j].fate || !(distance_m <= max_distance_m)) return std::nullopt;
    return distance_m;
  });
}

}  // namespace povslam::scores
