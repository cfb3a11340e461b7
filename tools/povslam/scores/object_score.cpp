#include "tools/povslam/scores/object_score.hpp"

#include <utility>

#include "tools/povslam/scores/join.hpp"

namespace povslam::scores {

std::vector<ScoredObject> join_touching(std::vector<ScoredObject> objects, double gap_m) {
  return join_where(std::move(objects), [gap_m](const ScoredObject& a, const ScoredObject& b) {
    return a.class_name == b.class_name && boxes_touch(a.box, b.box, gap_m);
  });
}

Verdict score_objects(std::span<const ScoredObject> truth, std::span<const ScoredObject> reported, double min_iou) {
  std::vector<char> required;
  for (const ScoredObject& object : truth) required.push_back(object.required ? 1 : 0);
  return judge(required, reported.size(), [&](std::size_t i, std::size_t j) -> std::optional<double> {
    const double iou = box_iou(truth[i].box, reported[j].box);
    if (!(iou >= min_iou) || iou <= 0.0) return std::nullopt;
    return 1.0 - iou;
  });
}

}  // namespace povslam::scores
