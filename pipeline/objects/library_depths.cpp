// How deep things of a class are, learned from those seen from two sides: what is assumed of the others.
#include <algorithm>
#include <cmath>

#include "pipeline/objects/library.hpp"

namespace povslam {

double ObjectLibrary::deepest_m(const MapObject& object) const {
  const auto known = deepest_m_.find(object.class_id());
  return known == deepest_m_.end() ? kDeepest_m : known->second;
}

// Something before or beside it may hide where a side ends, so that each is seen to be so deep at least.
void ObjectLibrary::learn_depths() {
  constexpr std::size_t kEnough = 5;
  constexpr double kMost = 0.9, kHardly_m = 0.01;
  std::map<std::uint16_t, std::vector<double>> depths;
  for (const auto& object : objects_) {
    if (object->phase != ObjectPhase::confirmed) continue;
    if (const auto depth_m = depth_seen(object->seen)) depths[object->class_id()].push_back(*depth_m);
  }
  for (auto& [id, all] : depths) {
    if (all.size() < kEnough) continue;
    const auto most = all.begin() + std::lround(kMost * static_cast<double>(all.size() - 1));
    std::ranges::nth_element(all, most);
    double& known_m = deepest_m_.try_emplace(id, kDeepest_m).first->second;
    const double deepest_m = std::min(*most, kDeepest_m);
    if (std::abs(deepest_m - known_m) < kHardly_m) continue;
    known_m = deepest_m;
    for (const auto& object : objects_) {
      if (object->class_id() == id) object->box = with_depth(object->seen, deepest_m);
    }
  }
}

}  // namespace povslam
