// Shelves: long level boards, with things standing on them whose fronts are flush with the board's edge. Depth alone
// shows one surface there; but the board runs on level where the things have gaps between them.
#pragma once

#include <vector>

#include "pipeline/objects/segment_grid.hpp"

namespace povslam {

class BoardFinder {
 public:
  // Labels the cells of boards kStructurePart. True: there were some, parts must be found anew.
  bool mark(int num_parts, const SegmentOptions& options, SegmentGrid& grid);

 private:
  struct Run {  // of cells at one height, from column to column of the image
    float start_x = 0.0F, start_y = 0.0F, end_x = 0.0F, end_y = 0.0F;
    int first = 0, last = 0;
    float length() const;
  };
  bool mark_part(int part, const std::vector<std::size_t>& cells, const SegmentOptions& options, SegmentGrid& grid);
  void find_runs(const std::vector<std::size_t>& cells, const SegmentGrid& grid);

  std::vector<std::vector<std::size_t>> cells_;  // of each part
  std::vector<float> column_x_, column_y_;       // of each bin and column: a point there
  std::vector<std::uint8_t> there_;
  std::vector<std::vector<Run>> runs_;  // of each bin: the long ones
  float bottom_ = 0.0F;
  int bins_ = 0;
};

}  // namespace povslam
