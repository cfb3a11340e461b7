// Geometric segmentation: what stands apart in a depth image, without any network (gravity-aware).
#pragma once

#include <memory>

#include "pipeline/mapping/depth_view.hpp"

namespace povslam {

struct SegmentOptions {
  int min_pixels = 500;         // of the full image
  double normal_cosine = 0.94;  // a concave fold sharper than this separates
  double jump_share = 0.01;     // of the depth: a larger jump separates…
  double jump_sigmas = 6.0;     // …if it is this many sigmas of the depth noise
  double depth_sigma_quadratic_per_m = 0.0025;
  double wall_area_m2 = 4.0;        // an upright plane larger than this, or longer than
  double wall_length_m = 3.0;       // this, is structure
  double floor_tolerance_m = 0.06;  // about the floor's height, plus 3 sigma
};

struct Segment {
  int pixels = 0;  // full image
  bool structure = false;
  bool at_border = false;  // of the image
};

// One object per camera: the floor's height is tracked over frames in the world (z up). Deterministic.
class Segmenter {
 public:
  Segmenter(const PinholeCamera& camera, const SegmentOptions& options);
  ~Segmenter();

  // instances: per pixel of the view (its full size), kNobody on edges and where nothing was measured, kStructure, or
  // kFirstInstance + i for segment i of the result that is no structure. Valid until the next call.
  const std::vector<Segment>& segment(const DepthView& view, ImageU16& instances);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace povslam
