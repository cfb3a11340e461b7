// Events of change against the truth.
//
// A move is one *gone* (its old place) and one *came* (its new place); removed is a gone, appeared a came. Boxes of one
// class that touch and share their fate count as one, in the truth and in the report alike. Report and truth are
// matched one-to-one, gone to gone and came to came, within max_distance_m horizontally, whatever the class. A true
// change whose place was hardly seen afterwards need not be found, and a report of it is neither right nor wrong.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/povslam/scores/matching.hpp"
#include "tools/povslam/scores/scene_files.hpp"

namespace povslam::scores {

enum class Fate : std::uint8_t { gone, came };

struct PlaceChange {
  Fate fate = Fate::came;
  std::string class_name;
  OrientedBox box;
  bool required = true;  // truth only: its place was visible often enough afterwards
};

std::vector<PlaceChange> changes_of(std::span<const ReportedEvent> events);

// Touching boxes of one class and fate become one; it is required if one of them is.
std::vector<PlaceChange> join_touching(std::vector<PlaceChange> changes, double gap_m);

// Cost of a pair: its horizontal distance [m].
Verdict score_events(std::span<const PlaceChange> truth, std::span<const PlaceChange> reported, double max_distance_m);

}  // namespace povslam::scores
