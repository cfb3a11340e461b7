// What can be said of each part: how big it is, how it lies, and which of its outlines are its own.
#pragma once

#include <vector>

#include "pipeline/objects/segment_grid.hpp"

namespace povslam {

struct PartMeasure {
  int cells = 0;
  float area_m2 = 0.0F;
  float bottom_m = 0.0F, top_m = 0.0F;           // level heights
  float length_m = 0.0F, width_m = 0.0F;         // seen from above, along the principal axes
  float up = 0.0F, down = 0.0F, upright = 0.0F;  // shares of the area that face so
  float flatness = 0.0F;                         // share that faces as the mean does
  // Cells of the outline by what lies across: something behind it (the outline is this part's own), something before it
  // (the part runs on behind that), something it touches, nothing measured, or the image's border.
  int own = 0, covered = 0, touching = 0, open = 0;
  int border_top = 0, border_bottom = 0, border_side = 0;
  int outline() const { return own + covered + touching + open + border_top + border_bottom + border_side; }
};

void measure_parts(int num_parts, const SegmentOptions& options, const SegmentGrid& grid,
                   std::vector<PartMeasure>& measures);

}  // namespace povslam
