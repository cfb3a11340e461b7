// Which parts are things, and which belong to the building.
#pragma once

#include "pipeline/objects/segment_measure.hpp"

namespace povslam {

// Share of the outline that can be told to be the part's own; 1 if nothing is told.
double own_share(const PartMeasure& part);

bool is_structure(const PartMeasure& part, const SegmentOptions& options);

}  // namespace povslam
