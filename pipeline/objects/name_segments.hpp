// Names geometric segments by a detector's boxes: depth says where a thing ends, the box what it is (after Grinvald et
// al., voxblox++, RA-L 2019, with boxes in place of masks).
#pragma once

#include <span>
#include <vector>

#include "pipeline/mapping/depth_view.hpp"
#include "pipeline/objects/segment_boxes.hpp"

namespace povslam {

struct NameOptions {
  double inside = 0.7;  // a box holds a segment with this share of its pixels
  double filled = 0.1;  // and names it if the segment covers this share of the box's own pixels with an owner
};

struct SegmentName {
  int class_index = -1;  // of the detector's list; -1: none
  float score = 0.0F;
};

// One name a segment, in their order; instances as Segmenter::segment() gives them, boxes in the same pixels. Of
// several boxes that hold a segment the smallest names it: a cup's before the table's. Structure is never named. A
// single look is not to be believed: count names over looks.
std::vector<SegmentName> name_segments(std::span<const DetectedBox> boxes, const ImageU16& instances,
                                       std::size_t num_segments, const NameOptions& options);

}  // namespace povslam
