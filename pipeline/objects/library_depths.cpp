// How deep things are, learned from those seen from two sides: what is assumed of the others.
#include <algorithm>
#include <cmath>
#include <ranges>

#include "pipeline/objects/library.hpp"

namespace povslam {
namespace {

constexpr std::size_t kEnough = 5;
constexpr double kMost = 0.9;

// Horizontal, world: which way the side looks that it shows most of.
Eigen::Vector2d front_normal(const MapObject& object, const Box& box_world) {
  const auto& sides = object.seen.sides;
  const bool x = std::max(sides[0], sides[1]) >= std::max(sides[2], sides[3]);
  return Eigen::Rotation2Dd(box_world.yaw) * (x ? Eigen::Vector2d::UnitX() : Eigen::Vector2d::UnitY());
}

// Something before or beside it may hide where a side ends, so that each is seen to be so deep at least.
double most_of(std::vector<double>& depths) {
  const auto most = depths.begin() + std::lround(kMost * static_cast<double>(depths.size() - 1));
  std::ranges::nth_element(depths, most);
  return std::min(*most, kDeepest_m);
}

}  // namespace

// Of a class that was guessed, which may be no more than "thing", what stands beside, above and below says more than
// all there are of it.
double ObjectLibrary::deepest_m(const MapObject& object) const {
  constexpr double kInRow_m = 0.25;
  constexpr std::size_t kNearest = 15;
  const Box box = object.box_world();
  const Eigen::Vector2d front = front_normal(object, box);
  std::vector<std::pair<double, double>> near;  // distance, depth
  for (const KnownDepth& known : known_depths_) {
    const Eigen::Vector3d apart = known.at - box.center;
    const bool in_row = std::abs(front.dot(apart.head<2>())) < kInRow_m;
    if (known.object == object.id || known.class_id != object.class_id() || !in_row) continue;
    near.emplace_back(apart.norm(), known.depth_m);
  }
  if (object.class_binds || near.size() < kEnough) {
    const auto known = deepest_m_.find(object.class_id());
    return known == deepest_m_.end() ? kDeepest_m : known->second;
  }
  std::ranges::sort(near);
  std::vector<double> depths;
  for (const auto& [distance_m, depth_m] : near | std::views::take(kNearest)) depths.push_back(depth_m);
  return most_of(depths);
}

void ObjectLibrary::learn_depths(const std::vector<MapObject*>& reach) {
  constexpr double kHardly_m = 0.01;
  known_depths_.clear();
  std::map<std::uint16_t, std::vector<double>> depths;
  for (const auto& object : objects_) {
    if (object->phase != ObjectPhase::confirmed) continue;
    const auto depth_m = depth_seen(object->seen);
    if (!depth_m) continue;
    known_depths_.push_back({object->id, object->class_id(), object->box_world().center, *depth_m});
    depths[object->class_id()].push_back(*depth_m);
  }
  const auto assume = [this](MapObject& object) {
    if (object.seen.box.size_m.x() > 0.0) settle(object);
  };
  for (auto& [id, all] : depths) {
    if (all.size() < kEnough) continue;
    double& known_m = deepest_m_.try_emplace(id, kDeepest_m).first->second;
    const double deepest = most_of(all);
    if (std::abs(deepest - known_m) < kHardly_m) continue;
    known_m = deepest;
    for (const auto& object : objects_) {
      if (object->class_id() == id) assume(*object);
    }
  }
  for (MapObject* object : reach) assume(*object);
}

}  // namespace povslam
