// Pieces of one thing that depth alone keeps apart.
#pragma once

#include <vector>

#include "pipeline/objects/segment_measure.hpp"

namespace povslam {

// A lid - level, seen at a grazing angle - joins the part whose upper end it lies on; a plinth - a strip on the floor,
// such as a pallet's - joins what stands on it. A lid that lies on structure becomes structure. True: any did.
bool join_parts(const std::vector<PartMeasure>& measures, const SegmentOptions& options, SegmentGrid& grid);

}  // namespace povslam
