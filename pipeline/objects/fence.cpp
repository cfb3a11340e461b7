#include "pipeline/objects/fence.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/objects/object.hpp"

namespace povslam {
namespace {

constexpr double kSame_m = 0.08;
constexpr double kMostVotes = 6.0, kKnown = 2.0, kAgainst = 0.5;

Eigen::Vector2d turned(const Eigen::Vector2d& v, double yaw) {
  return Eigen::Rotation2Dd(yaw) * v;
}

bool same(const MapObject& object, const ObjectFence& a, const ObjectFence& b) {
  const Eigen::Vector2d way = facing(object, a);
  return std::abs(way.dot(facing(object, b))) > 0.5 && std::abs(way.dot(a.fence.at - b.fence.at)) < kSame_m;
}

void vote(MapObject& object, const ObjectFence& seen) {
  const auto known =
      std::ranges::find_if(object.fences, [&](const ObjectFence& fence) { return same(object, fence, seen); });
  if (known == object.fences.end()) {
    object.fences.push_back(seen);
    return;
  }
  if (known->last_vote == seen.last_vote) return;
  const double share = 1.0 / (known->votes + 1.0);
  known->fence.at += share * (seen.fence.at - known->fence.at);
  known->fence.outward = seen.fence.outward;
  known->votes = std::min(known->votes + 1.0, kMostVotes);
  known->last_vote = seen.last_vote;
}

// Whether the observation shows much on both sides.
bool spans(const MapObject& object, const ObjectFence& fence, const Observation& observation) {
  constexpr double kClear_m = 0.08, kShare = 0.1;
  const Eigen::Vector2d way = facing(object, fence);
  const Rigid3 T_volume_world = object.T_world_volume.inverse();
  std::size_t within = 0, beyond = 0;
  for (const Eigen::Vector3f& p : observation.points_world) {
    const double d = way.dot((T_volume_world * p.cast<double>()).head<2>() - fence.fence.at);
    within += d < -kClear_m ? 1 : 0;
    beyond += d > kClear_m ? 1 : 0;
  }
  return static_cast<double>(std::min(within, beyond)) > kShare * static_cast<double>(observation.points_world.size());
}

}  // namespace

Eigen::Vector2d facing(const MapObject& object, const ObjectFence& fence) {
  const Eigen::Vector2d own = turned(fence.fence.outward, -object.box.yaw);
  const Eigen::Vector2d axis =
      std::abs(own.x()) > std::abs(own.y()) ? Eigen::Vector2d::UnitX() : Eigen::Vector2d::UnitY();
  const Eigen::Vector2d way = turned(axis, object.box.yaw);
  return way.dot(fence.fence.at - object.box.center.head<2>()) < 0.0 ? Eigen::Vector2d(-way) : way;
}

void add_firm_fence(MapObject& object, const Eigen::Vector2d& at, const Eigen::Vector2d& along) {
  object.fences.push_back({{at, along}, kMostVotes, 0, true});
}

void note_fences(MapObject& object, std::span<const Observation* const> observations, TimeNs stamp) {
  const Rigid3 T_volume_world = object.T_world_volume.inverse();
  const double turn = yaw_of(T_volume_world);
  for (ObjectFence& fence : object.fences) {
    if (fence.firm) continue;
    const bool one = std::ranges::any_of(observations, [&](const auto* seen) { return spans(object, fence, *seen); });
    if (one) fence.votes -= kAgainst;
  }
  std::erase_if(object.fences, [](const ObjectFence& fence) { return fence.votes <= 0.0; });
  for (const Observation* observation : observations) {
    for (const Fence& seen : observation->fences) {
      const Eigen::Vector3d at = T_volume_world * Eigen::Vector3d(seen.at.x(), seen.at.y(), object.box.center.z());
      vote(object, {{at.head<2>(), turned(seen.outward, turn)}, 1.0, stamp});
    }
  }
}

std::vector<FencePlane> known_fences(const MapObject& object) {
  std::vector<FencePlane> planes;
  for (const ObjectFence& fence : object.fences) {
    if (fence.votes >= kKnown) planes.push_back({fence.fence.at, facing(object, fence)});
  }
  return planes;
}

bool fenced_off(const MapObject& object, const Observation& observation) {
  const std::vector<FencePlane> planes = known_fences(object);
  if (planes.empty()) return false;
  const Rigid3 T_volume_world = object.T_world_volume.inverse();
  return std::ranges::any_of(planes, [&](const FencePlane& plane) {
    std::size_t beyond = 0;
    for (const Eigen::Vector3f& p : observation.points_world) {
      beyond += plane.distance_m(T_volume_world * p.cast<double>()) > 0.0 ? 1 : 0;
    }
    return 2 * beyond > observation.points_world.size();
  });
}

bool fenced_apart(const MapObject& a, const MapObject& b) {
  const auto beyond = [](const MapObject& from, const MapObject& to) {
    const Eigen::Vector2d center = (from.T_world_volume.inverse() * to.box_world().center).head<2>();
    return std::ranges::any_of(
        from.fences, [&](const ObjectFence& fence) { return facing(from, fence).dot(center - fence.fence.at) > 0.0; });
  };
  return beyond(a, b) || beyond(b, a);
}

}  // namespace povslam
