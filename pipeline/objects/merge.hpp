// Two objects that turned out to be one.
#pragma once

#include "pipeline/objects/object.hpp"

namespace povslam {

// Brings what b knows into a: its surface is sampled into a's volume, votes and times are joined; a's belief stays.
void merge_into(MapObject& a, const MapObject& b);

}  // namespace povslam
