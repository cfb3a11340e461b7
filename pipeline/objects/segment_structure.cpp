#include "pipeline/objects/segment_structure.hpp"

namespace povslam {

namespace {

constexpr float kMost = 0.6F;      // share of the area
constexpr float kCutTall = 0.65F;  // of tall_m, for what leaves the image at its top

bool rises_too_high(const PartMeasure& part, const SegmentOptions& options) {
  const float height = part.top_m - part.bottom_m;
  const auto tall = static_cast<float>(options.tall_m);
  return height > tall || (part.border_top > 2 && height > kCutTall * tall);
}

bool is_wall(const PartMeasure& part, const SegmentOptions& options) {
  if (part.length_m > static_cast<float>(options.wall_length_m)) return true;
  return part.upright > kMost && part.flatness > kMost && part.area_m2 > static_cast<float>(options.wall_area_m2);
}

// A shelf's underside, a ceiling.
bool hangs_over(const PartMeasure& part) {
  return part.down > kMost;
}

// What the eye takes for background: flat, and bounded by things that stand before it.
bool is_background(const PartMeasure& part, const SegmentOptions& options) {
  return part.flatness > kMost && own_share(part) < options.own_outline;
}

}  // namespace

double own_share(const PartMeasure& part) {
  const double own = part.own + part.open, told = own + part.covered + part.border_top + part.border_side;
  return told > 0.0 ? own / told : 1.0;
}

bool is_structure(const PartMeasure& part, const SegmentOptions& options) {
  return rises_too_high(part, options) || is_wall(part, options) || hangs_over(part) || is_background(part, options);
}

}  // namespace povslam
