// Parts of an image that hang together, on the coarse grid.
#pragma once

#include <vector>

#include "pipeline/objects/segment_grid.hpp"

namespace povslam {

// Labels what hangs together kFirstPart, …; cells labelled kStructurePart and edges stay out. Parts of fewer than
// min_cells go back to kNoPart. Returns the number of parts.
class PartFinder {
 public:
  int find(const SegmentOptions& options, int min_cells, SegmentGrid& grid);

 private:
  int root(int label);

  std::vector<int> parent_, renamed_, cells_;
};

// Edges and what was left over join the part beside them that is closest in depth.
void grow_parts(const SegmentOptions& options, SegmentGrid& grid);

}  // namespace povslam
