// The object library against the true boxes: matched one-to-one at box IoU >= min_iou, whatever the class (a label
// source may know fewer). Boxes of one class that touch count as one, in the truth and in the report alike; each_box in
// the report: no two are joined.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/povslam/scores/matching.hpp"
#include "tools/povslam/scores/oriented_box.hpp"

namespace povslam::scores {

struct ScoredObject {
  std::string class_name;
  OrientedBox box;
  bool required = true;  // truth only: seen often enough; a report of one that was not is neither right nor wrong
};

std::vector<ScoredObject> join_touching(std::vector<ScoredObject> objects, double gap_m);

// Cost of a pair: 1 - IoU.
Verdict score_objects(std::span<const ScoredObject> truth, std::span<const ScoredObject> reported, double min_iou);

}  // namespace povslam::scores
