// Things from labels and depth: each connected part of one class becomes an observation, and owns its pixels.
#pragma once

#include <memory>
#include <vector>

#include "pipeline/objects/class_table.hpp"
#include "pipeline/objects/observation.hpp"
#include "pipeline/objects/options.hpp"
#include "pipeline/objects/segment_namer.hpp"

namespace povslam {

struct Extraction {
  std::vector<Observation> observations;  // Observation::owner = kFirstInstance + index
};

class Extractor {
 public:
  Extractor(const ExtractOptions& options, double depth_sigma_quadratic_per_m);
  ~Extractor();

  // classes: of the view's pixels (same size). Parts: neighbours of one class and of nearly one depth, at half
  // resolution, after erosion; parts of a class that a nearer thing divides are one. Writes view.owner.
  const Extraction& from_classes(const ImageU8& classes, const ClassTable& table, DepthView& view);

  // instances: of the view's pixels, as in DepthView::owner; the class of instance i, which does not bind: geometry
  // told them apart. Writes view.owner (eroded).
  const Extraction& from_instances(const ImageU16& instances, const std::vector<SegmentClass>& class_of,
                                   DepthView& view);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace povslam
