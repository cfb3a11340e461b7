// Two objects that may be one thing with something before its middle: a post of its rack, a thing that stands nearer.
#pragma once

#include "pipeline/mapping/depth_view.hpp"
#include "pipeline/objects/object.hpp"

namespace povslam {

// Level with each other, their fronts in one plane, no wider together than widest_m, hardly apart.
bool may_be_halves(const MapObject& a, const MapObject& b, double widest_m);

enum class Between : std::uint8_t {
  unseen,  // not in the view
  hidden,  // by something nearer
  open     // seen through: nothing of theirs is there
};
// What the view shows of the middle between two that may be halves.
Between look_between(const MapObject& a, const MapObject& b, const DepthView& view);

}  // namespace povslam
