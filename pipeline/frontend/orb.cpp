#include "pipeline/frontend/orb.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/base/expects.hpp"
#include "pipeline/frontend/kernels/dispatch.hpp"
#include "pipeline/frontend/orb_pattern.hpp"
#include "pipeline/frontend/orb_pyramid.hpp"
#include "pipeline/frontend/orb_spread.hpp"

namespace povslam {
namespace {

// Features keep this far from the edge of their level: the patch, and what refinement may move them by.
constexpr int kMarginPx = kPatchRadius + 1;
constexpr int kMinLevelEdgePx = 2 * kMarginPx + 8;
static_assert(kOrbBorder >= 3, "corner detection and smoothing look three pixels past the edge");

PixelRect feature_area(const PyramidLevel& level) {
  return {kMarginPx, kMarginPx, level.width - kMarginPx, level.height - kMarginPx};
}

}  // namespace

OrbFeatures::OrbFeatures(int capacity_)
    : capacity(capacity_),
      x(capacity_),
      y(capacity_),
      angle(capacity_),
      response(capacity_),
      level(capacity_),
      descriptor(capacity_) {}

struct OrbExtractor::Impl {
  Impl(int width, int height, const OrbOptions& options, const FrontendKernels& kernels);
  void extract_level(int index, int wanted, OrbFeatures& features);
  int refine(const PyramidLevel& level, int count);
  void smooth(const PyramidLevel& level);
  void add(const FastCorner& corner, int index, OrbFeatures& features) const;

  OrbOptions options;
  const FrontendKernels& kernels;
  OrbPyramid pyramid;
  BriefPattern pattern;
  PatchMask patch = round_patch();
  std::vector<CornerSpread> spreads;
  std::vector<int> quotas;  // features per level
  std::vector<FastCorner> corners;
  std::vector<std::uint8_t> corner_scratch, smooth_scratch, smoothed;
  std::vector<std::uint8_t> occupied;  // pixels that hold a refined corner; all 0 between calls
};

OrbExtractor::Impl::Impl(int width, int height, const OrbOptions& given, const FrontendKernels& chosen)
    : options(given),
      kernels(chosen),
      pyramid(width, height, given.num_levels, given.scale_factor, kMinLevelEdgePx),
      pattern(pyramid.levels()[0].stride) {
  EXPECTS(std::min(width, height) >= kMinLevelEdgePx && std::max(width, height) <= 65535);
  EXPECTS(given.num_features >= 1 && given.cell_px >= 1);
  EXPECTS(given.min_fast_threshold >= 1 && given.min_fast_threshold <= given.fast_threshold &&
          given.fast_threshold < 255);
  double total_area = 0.0;
  for (const PyramidLevel& level : pyramid.levels()) {
    spreads.emplace_back(feature_area(level), given.cell_px);
    total_area += 1.0 / (level.scale * level.scale);
  }
  // As many features per pixel on every level; coarser levels get what rounding or a finer level leaves.
  for (const PyramidLevel& level : pyramid.levels()) {
    quotas.push_back(static_cast<int>(std::lround(given.num_features / (level.scale * level.scale * total_area))));
  }
  const PyramidLevel& finest = pyramid.levels()[0];
  corners.resize(static_cast<std::size_t>(width / 2 + 1) * (height / 2 + 1));
  corner_scratch.resize(3 * (static_cast<std::size_t>(width) + 2 * kKernelSlack));
  smooth_scratch.resize(static_cast<std::size_t>(width) + 2 * kKernelSlack);
  smoothed.resize(static_cast<std::size_t>(finest.stride) * (height + 1));
  occupied.resize(smoothed.size());
}

// Moves the first `count` corners to their peaks; keeps, in order, those that have one inside the area and to
// themselves, and returns how many.
int OrbExtractor::Impl::refine(const PyramidLevel& level, int count) {
  const PixelRect area = feature_area(level);
  int kept = 0;
  for (int k = 0; k < count; ++k) {
    FastCorner corner = corners[k];
    CornerPeak peak;
    if (!kernels.refine_corner(level.pixels + corner.y * level.stride + corner.x, level.stride, &peak)) continue;
    const int x = corner.x + peak.column, y = corner.y + peak.row;
    if (x < area.x0 || x >= area.x1 || y < area.y0 || y >= area.y1) continue;
    std::uint8_t& taken = occupied[static_cast<std::size_t>(y * level.stride + x)];
    if (taken != 0) continue;
    taken = 1;
    corner.x = static_cast<std::uint16_t>(x);
    corner.y = static_cast<std::uint16_t>(y);
    corner.dx = peak.x;
    corner.dy = peak.y;
    corners[kept++] = corner;
  }
  for (int k = 0; k < kept; ++k) occupied[static_cast<std::size_t>(corners[k].y * level.stride + corners[k].x)] = 0;
  return kept;
}

void OrbExtractor::Impl::smooth(const PyramidLevel& level) {
  for (int y = 0; y < level.height; ++y) {
    const std::int64_t row = y * level.stride;
    kernels.smooth_row(level.pixels + row, level.stride, level.width, smooth_scratch.data(), smoothed.data() + row);
  }
}

void OrbExtractor::Impl::add(const FastCorner& corner, int index, OrbFeatures& features) const {
  const PyramidLevel& level = pyramid.levels()[index];
  const std::int64_t offset = corner.y * level.stride + corner.x;
  const PatchMoments moments = kernels.patch_moments(level.pixels + offset, level.stride, &patch);
  const int k = features.size++;
  features.x[k] = (static_cast<float>(corner.x) + corner.dx + 0.5F) * level.scale - 0.5F;
  features.y[k] = (static_cast<float>(corner.y) + corner.dy + 0.5F) * level.scale - 0.5F;
  features.angle[k] = steady_atan2(static_cast<float>(moments.y), static_cast<float>(moments.x));
  features.response[k] = corner.score;
  features.level[k] = static_cast<std::uint8_t>(index);
  const BriefPattern::Offsets tests = pattern.at_angle(features.angle[k]);
  kernels.brief(smoothed.data() + offset, tests.first, tests.second, features.descriptor[k].data());
}

void OrbExtractor::Impl::extract_level(int index, int wanted, OrbFeatures& features) {
  const PyramidLevel& level = pyramid.levels()[index];
  const int found = kernels.find_corners({level.pixels, level.stride}, feature_area(level), options.min_fast_threshold,
                                         corner_scratch.data(), corners.data());
  // Twice as many as wanted are refined: about a third turns out to be edges, noise or the same corner again.
  CornerSpread& spread = spreads[index];
  const int candidates = spread.choose(corners.data(), found, 2 * wanted, options.fast_threshold);
  const int refined = refine(level, candidates);
  const int chosen = spread.choose(corners.data(), refined, wanted, options.fast_threshold);
  if (chosen == 0) return;
  smooth(level);
  for (int k = 0; k < chosen; ++k) add(corners[k], index, features);
}

OrbExtractor::OrbExtractor(int width, int height, const OrbOptions& options)
    : OrbExtractor(width, height, options, frontend_kernels()) {}
OrbExtractor::OrbExtractor(int width, int height, const OrbOptions& options, const FrontendKernels& kernels)
    : impl_(std::make_unique<Impl>(width, height, options, kernels)) {}
OrbExtractor::~OrbExtractor() = default;
OrbExtractor::OrbExtractor(OrbExtractor&&) noexcept = default;
OrbExtractor& OrbExtractor::operator=(OrbExtractor&&) noexcept = default;

void OrbExtractor::extract(const std::uint8_t* grey, std::int64_t stride, OrbFeatures& features,
                           std::span<const FeatureWish> wishes) {
  EXPECTS(features.capacity >= impl_->options.num_features);
  EXPECTS(stride >= impl_->pyramid.levels()[0].width);
  impl_->pyramid.build(impl_->kernels, grey, stride);
  features.size = 0;
  int quota = 0;  // of the levels so far
  for (int l = 0; l < num_levels(); ++l) {
    impl_->spreads[static_cast<std::size_t>(l)].favour(wishes, scale(l));
    quota = l + 1 == num_levels() ? impl_->options.num_features : quota + impl_->quotas[l];
    impl_->extract_level(l, std::min(quota, impl_->options.num_features) - features.size, features);
  }
}

int OrbExtractor::num_levels() const {
  return static_cast<int>(impl_->pyramid.levels().size());
}
const PyramidLevel& OrbExtractor::level(int index) const {
  return impl_->pyramid.levels()[index];
}
float OrbExtractor::scale(int index) const {
  return static_cast<float>(std::pow(impl_->options.scale_factor, index));
}

void rgb_to_grey(const std::uint8_t* rgb, std::uint8_t* grey, std::int64_t count) {
  frontend_kernels().rgb_to_grey(rgb, grey, count);
}

NearestDescriptor nearest_descriptor(const Descriptor& query, const Descriptor* candidates, int count) {
  NearestDescriptor nearest;
  for (int k = 0; k < count; ++k) {
    const int distance = hamming_distance(query, candidates[k]);
    if (distance >= nearest.second_distance) continue;
    if (distance >= nearest.distance) {
      nearest.second_distance = distance;
      continue;
    }
    nearest.second_distance = nearest.distance;
    nearest.distance = distance;
    nearest.index = k;
  }
  return nearest;
}

}  // namespace povslam
