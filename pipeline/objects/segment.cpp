// Segmentation by gravity and depth alone: floor, edges, parts that hang together, shelves, and what of it is a thing.
// After Tateno et al. (IROS 2015) and Furrer et al. (IROS 2018); what differs is said where it is done.
#include "pipeline/objects/segment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/objects/segment_boards.hpp"
#include "pipeline/objects/segment_floor.hpp"
#include "pipeline/objects/segment_grid.hpp"
#include "pipeline/objects/segment_join.hpp"
#include "pipeline/objects/segment_measure.hpp"
#include "pipeline/objects/segment_parts.hpp"
#include "pipeline/objects/segment_structure.hpp"
#include "pipeline/objects/shelf_memory.hpp"

namespace povslam {

namespace {

// Noise cuts a surface at the end of the range into dust: a third of such cells, and nothing can be told of the part.
constexpr int kAtRange = 3;

}  // namespace

struct Segmenter::Impl {
  Impl(const PinholeCamera& camera_in, const SegmentOptions& options_in)
      : camera(camera_in), options(options_in), grid(camera_in) {}

  void find_parts(const DepthView& view);
  void judge();
  Segment describe(const PartMeasure& part) const;
  void paint(const ImageF& depth_m, ImageU16& instances);

  PinholeCamera camera;
  SegmentOptions options;
  SegmentGrid grid;
  FloorTracker floor;
  PartFinder parts;
  BoardFinder boards;
  ShelfMemory shelves;
  int num_parts = 0;
  std::vector<PartMeasure> measures;
  std::vector<std::uint16_t> instance_of;  // part -> instance
  std::vector<Segment> segments;
};

Segmenter::Segmenter(const PinholeCamera& camera, const SegmentOptions& options)
    : impl_(std::make_unique<Impl>(camera, options)) {}
Segmenter::~Segmenter() = default;

void Segmenter::Impl::find_parts(const DepthView& view) {
  std::fill(grid.label.begin(), grid.label.end(), kNoPart);
  take_depth(view, options, grid);
  find_surfaces(view.T_world_camera, options, grid);
  find_edges(options, grid);
  const auto camera_height_m = static_cast<float>(view.T_world_camera.translation.z());
  const std::optional<FloorPlane> plane = floor.track(grid, camera_height_m);
  if (plane) label_floor(*plane, options, grid);
  const float floor_height_m = plane ? plane->height : -std::numeric_limits<float>::max();
  label_undersides(camera_height_m, grid);
  const int min_cells = std::max(1, options.min_pixels / (grid.step * grid.step) / 2);  // they have yet to grow
  num_parts = parts.find(options, min_cells, grid);
  const bool shown = boards.mark(num_parts, floor_height_m, options, grid);
  const bool known = shelves.learn_and_mark(boards.places(), view.T_world_camera.translation.head<2>(), grid);
  if (shown || known) num_parts = parts.find(options, min_cells, grid);
  grow_parts(options, grid);
}

void Segmenter::Impl::judge() {
  constexpr std::size_t kMostSegments = 60000;  // instances are 16 bits
  measure_parts(num_parts, options, grid, measures);
  if (join_parts(measures, options, grid)) measure_parts(num_parts, options, grid, measures);
  instance_of.assign(static_cast<std::size_t>(num_parts) + kFirstPart, kNobody);
  instance_of[kStructurePart] = kStructure;
  segments.clear();
  for (std::size_t id = 0; id < measures.size(); ++id) {
    const PartMeasure& part = measures[id];
    const bool told =
        part.cells * grid.step * grid.step >= options.min_pixels && kAtRange * part.at_range <= part.cells;
    if (!told || segments.size() >= kMostSegments) continue;
    if (is_structure(part, options)) {
      instance_of[id + kFirstPart] = kStructure;
      continue;
    }
    instance_of[id + kFirstPart] = static_cast<std::uint16_t>(kFirstInstance + segments.size());
    segments.push_back(describe(part));
  }
}

Segment Segmenter::Impl::describe(const PartMeasure& part) const {
  Segment segment;
  segment.pixels = part.cells * grid.step * grid.step;
  segment.at_border = part.border_top + part.border_bottom + part.border_side + part.at_range > 0;
  segment.bottom_m = part.bottom_m;
  segment.top_m = part.top_m;
  segment.length_m = part.length_m;
  segment.width_m = part.width_m;
  segment.area_m2 = part.area_m2;
  segment.own_outline = own_share(part);
  return segment;
}

// From cells to pixels: a pixel belongs to its cell's part unless its own depth says that it shows something else.
void Segmenter::Impl::paint(const ImageF& depth_m, ImageU16& instances) {
  const auto gate = static_cast<float>(options.jump_sigmas * options.depth_sigma_quadratic_per_m);
  instances.resize(depth_m.width(), depth_m.height());
  instances.fill(kNobody);
  for (int y = 0; y < grid.height * grid.step; ++y) {
    const float* depth = depth_m.row(y);
    std::uint16_t* out = instances.row(y);
    const int row = grid.index(0, y / grid.step);
    for (int x = 0; x < grid.width * grid.step; ++x) {
      const auto i = static_cast<std::size_t>(row + x / grid.step);
      if (grid.w[i] <= 0.0F || !(depth[x] > 0.0F)) continue;
      if (std::abs(1.0F - grid.w[i] * depth[x]) < (gate + 0.02F * grid.w[i]) * depth[x])
        out[x] = instance_of[static_cast<std::size_t>(grid.label[i])];
    }
  }
}

const std::vector<Segment>& Segmenter::segment(const DepthView& view, ImageU16& instances) {
  EXPECTS(view.depth_m.width() == impl_->camera.width && view.depth_m.height() == impl_->camera.height);
  impl_->find_parts(view);
  impl_->judge();
  impl_->paint(view.depth_m, instances);
  return impl_->segments;
}

}  // namespace povslam
