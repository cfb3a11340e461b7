// Things of one class beside each other, as the box of one of them sees it.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "pipeline/objects/object.hpp"

namespace povslam {

// What was seen of the other, in the frame of the object's seen box; nothing if it stands askew to it.
std::optional<Eigen::AlignedBox3d> beside(const MapObject& object, const MapObject& other);

// A neighbour beyond an end of the object's front.
struct Neighbour {
  bool plus = false;   // which end
  double gap_m = 0.0;  // less than 0: they overlap
};
// Nothing unless both share much of their height and depth.
std::optional<Neighbour> neighbour(const MapObject& object, const MapObject& other, int along);

// Something nearer hid all that is between the two, in the views that showed the object.
bool hidden_between(const MapObject& object, const MapObject& other);

}  // namespace povslam
