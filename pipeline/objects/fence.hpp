// Between things of one class that stand side by side: where each of them ends.
#pragma once

#include <span>
#include <vector>

#include "pipeline/base/time.hpp"
#include "pipeline/objects/observation.hpp"

namespace povslam {

struct MapObject;

// Of an object, in its volume's frame.
struct ObjectFence {
  Fence fence;
  double votes = 0.0;  // views that told it from what is beyond, less those that took both for one
  TimeNs last_vote = 0;
  bool firm = false;  // many views together told it: no single one speaks against it
};

// A view's fences, and what it took for one across those that are known. observation: of the object, world frame.
void note_fences(MapObject& object, std::span<const Observation* const> observations, TimeNs stamp);

// Many views together found one; at, along: in the volume's frame.
void add_firm_fence(MapObject& object, const Eigen::Vector2d& at, const Eigen::Vector2d& along);

// Which way a fence faces: along an axis of the object's box, away from its centre.
Eigen::Vector2d facing(const MapObject& object, const ObjectFence& fence);

// A plane about which several views agree; p_volume: of points beyond it, positive.
struct FencePlane {
  Eigen::Vector2d at, outward;
  double distance_m(const Eigen::Vector3d& p_volume) const { return outward.dot(p_volume.head<2>() - at); }
};
std::vector<FencePlane> known_fences(const MapObject& object);

bool fenced_off(const MapObject& object, const Observation& observation);  // most of it lies beyond one
bool fenced_apart(const MapObject& a, const MapObject& b);                 // of one view at least

}  // namespace povslam
