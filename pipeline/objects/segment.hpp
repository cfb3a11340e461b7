// Geometric segmentation: what stands apart in a depth image, without any network (gravity-aware).
#pragma once

#include <memory>

#include "pipeline/mapping/depth_view.hpp"

namespace povslam {

struct SegmentOptions {
  int min_pixels = 500;         // of the full image
  double max_depth_m = 6.0;     // what is farther is not looked at; things that reach it are cut off there
  double normal_cosine = 0.94;  // a concave fold sharper than this separates
  double jump_share = 0.01;     // of the depth: a larger jump separates…
  double jump_sigmas = 5.0;     // …if it is this many sigmas of the depth noise
  double depth_sigma_quadratic_per_m = 0.0025;
  double wall_area_m2 = 4.0;        // an upright plane larger than this, or longer than
  double wall_length_m = 3.0;       // this, is structure
  double floor_tolerance_m = 0.06;  // about the floor's height, plus 3 sigma
  double tall_m = 2.2;              // what rises more than this is structure
  double pole_width_m = 0.16;       // thinner and much higher: a post, structure
  double board_length_m = 1.0;      // a level strip longer than this
  double board_thickness_m = 0.2;   // and not higher than this is a shelf: structure
  double own_outline = 0.25;        // a flat thing with a smaller share of outline of its own is the background
};

struct Segment {                         // of a thing: structure makes none
  int pixels = 0;                        // full image
  bool at_border = false;                // of the image, or of the range of sight: there may be more of it
  double bottom_m = 0.0, top_m = 0.0;    // world height
  double length_m = 0.0, width_m = 0.0;  // of what is seen, from above
  double area_m2 = 0.0;                  // of the surface seen
  double own_outline = 0.0;              // share of its outline that is not hidden by nearer things, [0, 1]
};

// One object per camera: the floor's height is tracked over frames in the world (z up). Deterministic.
class Segmenter {
 public:
  Segmenter(const PinholeCamera& camera, const SegmentOptions& options);
  ~Segmenter();

  // instances: per pixel of the view (its full size), kNobody on edges and where nothing was measured, kStructure, or
  // kFirstInstance + i for segment i of the result. Valid until the next call.
  const std::vector<Segment>& segment(const DepthView& view, ImageU16& instances);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace povslam
