// The floor of the geometric segmentation: where it is in the world, followed from frame to frame.
#pragma once

#include <optional>
#include <vector>

#include "pipeline/objects/segment_grid.hpp"

namespace povslam {

struct FloorPlane {  // z = tilt_x * x + tilt_y * y + height, level axes of one frame
  float tilt_x = 0.0F, tilt_y = 0.0F, height = 0.0F;
  float at(float x, float y) const { return tilt_x * x + tilt_y * y + height; }
};

class FloorTracker {
 public:
  // The floor of this frame, level where too little of it is seen to tell its tilt; nothing: none was ever seen.
  std::optional<FloorPlane> track(const SegmentGrid& grid, float camera_height_m);

 private:
  struct Level {
    float height = 0.0F;
    int cells = 0;
  };
  std::optional<Level> lowest_level(const SegmentGrid& grid, float camera_height_m);
  void follow(const std::optional<Level>& seen, int cells_of_grid);
  FloorPlane fit(const SegmentGrid& grid) const;

  std::optional<float> height_;
  int contradicted_ = 0;  // frames in a row
  std::vector<int> histogram_;
};

// Labels the floor's cells kStructurePart and all others kNoPart; what lies below the floor loses its depth (mirror
// images in a shiny floor).
void label_floor(const FloorPlane& floor, const SegmentOptions& options, SegmentGrid& grid);

}  // namespace povslam
