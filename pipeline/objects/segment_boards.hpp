// Shelves: long level boards, with things standing on them whose fronts are flush with the board's edge. Depth alone
// shows one surface there; but the board runs on level where the things have gaps between them.
#pragma once

#include <vector>

#include "pipeline/objects/segment_grid.hpp"

namespace povslam {

class BoardFinder {
 public:
  // Labels the cells of boards kStructurePart. True: there were some, parts must be found anew.
  bool mark(int num_parts, float floor_height_m, const SegmentOptions& options, SegmentGrid& grid);
  // Of the cells that the last call labelled; level axes of the grid.
  const std::vector<Eigen::Vector3f>& places() const { return places_; }

 private:
  struct Band {  // of heights, world
    float low = 0.0F, high = 0.0F;
  };
  struct Part {
    std::vector<std::size_t> cells;
    float extent_m = 0.0F, bottom = 0.0F, top = 0.0F;
  };
  void collect(int num_parts, const SegmentGrid& grid);
  void find_runs(const Part& part, float least_m, const SegmentGrid& grid);
  float run_length(int bin, std::size_t first, std::size_t last) const;
  // Long level strips with nothing of that length right above or below; lower than near_floor_m, where pallets have the
  // same shape, longer ones.
  void choose_free(float near_floor_m, const SegmentOptions& options);
  // Shorter ones at the foot of a part, at the height of a board that was found elsewhere in the image.
  void choose_at_known_heights(const Part& part, const SegmentOptions& options);
  bool label_chosen(const Part& part, SegmentGrid& grid);

  std::vector<Part> parts_;
  std::vector<Eigen::Vector3f> places_;
  std::vector<Band> boards_;  // found in this image
  // Of the part at hand, in bins of height:
  float bottom_ = 0.0F;
  int bins_ = 0;
  std::size_t columns_ = 0;
  std::vector<std::uint8_t> there_, on_run_;  // of each bin and column of the image
  std::vector<float> column_x_, column_y_;    // a point there
  std::vector<float> longest_m_;              // run of each bin
  std::vector<std::uint8_t> chosen_;          // bins
};

}  // namespace povslam
