#include "pipeline/understanding.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <span>
#include <utility>

#include "pipeline/base/time.hpp"
#include "pipeline/objects/label_join.hpp"
#include "pipeline/objects/library.hpp"
#include "pipeline/objects/loose_surface.hpp"
#include "pipeline/objects/restore_block.hpp"
#include "pipeline/objects/world_journal.hpp"
#include "pipeline/structure_anchors.hpp"

namespace povslam {
namespace {

// One look from 3 m is a fifth. Of the exported map: no surfaces along lines of sight, none smaller than a voxel's
// face.
const MeshOptions kMap{.min_weight = 3.0 / kWeightUnits, .rims = false};

float ms(TimeNs span) {
  return static_cast<float>(to_ms(span));
}

// Segments have no class but that of things, or what they may be named.
ClassTable classes_for(const UnderstandingOptions& options, ClassTable classes, const SegmentNamer* namer) {
  if (namer != nullptr) return with_unnamed_things(namer->classes());
  return by_geometry(options) ? geometric_classes() : std::move(classes);
}

LabelJoinOptions join_options(const UnderstandingOptions& options, const SensorCalibration& calibration) {
  LabelJoinOptions join;
  join.max_latency_s = by_geometry(options) ? 0.0 : options.label_max_latency_s;
  join.labels_come = !by_geometry(options);
  join.period_s = 1.0 / calibration.fps;
  join.width = calibration.camera.width;
  join.height = calibration.camera.height;
  return join;
}

}  // namespace

struct Understanding::Impl {
  Impl(const UnderstandingOptions& its_options, const SensorCalibration& calibration, ClassTable classes,
       std::unique_ptr<SegmentNamer> its_namer)
      : options(its_options),
        builder(calibration.camera, options.view),
        segmenter(calibration.camera, options.segment),
        namer(std::move(its_namer)),
        extractor(options.objects.extract, options.integrate.depth_sigma_quadratic_per_m),
        structure(options.structure),
        empty(options.empty),
        library(options.objects, options.object, options.integrate,
                classes_for(options, std::move(classes), namer.get())),
        join(join_options(options, calibration), library.classes()) {}

  void restore(const WorldContent& content) {
    library.restore(content.meta);
    std::map<std::int64_t, std::vector<const VoxelBlockRow*>> blocks;
    for (const VoxelBlockRow& row : content.blocks) blocks[row.volume].push_back(&row);
    for (const VoxelBlockRow* row : blocks[kStructureVolume]) restore_block(*row, structure);
    for (const ObjectRow& row : content.objects) library.restore(row, blocks[row.object.id]);
    for (const EmptyCellRow& cell : content.empty_cells) {
      empty.restore({cell.x, cell.y, cell.z, {cell.first, cell.last, cell.times}});
    }
    structure_anchors.note(structure, -1);  // what was learned before hangs on no keyframe of this session's views
    journal.assume_told(content, library, structure);
    list_objects();
  }

  WorldChange* collect() {
    EXPECTS(!change_out);
    change.clear();
    journal.collect(library, structure, empty, change);
    last_change = newest_view;
    change_out = !change.empty();
    return change_out ? &change : nullptr;
  }

  // The map was corrected before this view: what earlier ones made follows, and nothing is told of it.
  void correct(const View& view) {
    while (!corrections.empty() && corrections.front().stamp <= view.stamp()) {
      const std::vector<KeyframeMotion> motions = std::move(corrections.front().motions);
      corrections.pop_front();
      library.correct(motions);
      structure_anchors.carry(structure, motions);
      if (loose) loose.emplace(options.structure, options.integrate);  // nobody's, and seen again soon
      forget_moved_cells(motions);
    }
    if (view_of_keyframe.empty() || view_of_keyframe.back().keyframe != view.reference_keyframe) {
      constexpr std::ptrdiff_t kMost = 1 << 16;  // places seen longer ago count as not moved
      if (std::ssize(view_of_keyframe) == kMost) {
        view_of_keyframe.erase(view_of_keyframe.begin(), view_of_keyframe.begin() + kMost / 2);
      }
      view_of_keyframe.push_back({view.stamp(), view.reference_keyframe});
    }
  }

  // An empty place remembered somewhere else would make things that stand there look as if they came.
  void forget_moved_cells(std::span<const KeyframeMotion> motions) {
    const double cell_m = options.empty.cell_size_m;
    const auto moved = [&](const EmptySpace::Cell& cell) {
      const auto after = std::ranges::upper_bound(view_of_keyframe, cell.seen.last, {}, &ViewOfKeyframe::first);
      if (after == view_of_keyframe.begin()) return false;
      const Rigid3* T_new_old = motion_of(motions, std::prev(after)->keyframe);
      const Eigen::Vector3d p = (Eigen::Vector3d(cell.x, cell.y, cell.z) + Eigen::Vector3d::Constant(0.5)) * cell_m;
      return T_new_old != nullptr && (*T_new_old * p - p).norm() > 0.5 * cell_m;
    };
    std::vector<EmptySpace::Cell> cells = empty.cells(0);
    if (std::erase_if(cells, moved) == 0) return;
    empty = EmptySpace(options.empty);
    for (const EmptySpace::Cell& cell : cells) empty.restore(cell);
  }

  const Extraction* extract(const LabelFrame* labels) {
    if (labels != nullptr) {
      builder.rectify_labels(*labels, class_image);
      return &extractor.from_classes(class_image, library.classes(), seen);
    }
    if (!by_geometry(options)) return nullptr;
    const std::size_t count = segmenter.segment(seen, instances).size();
    if (namer == nullptr) {
      class_of.assign(count, {});
      return &extractor.from_instances(instances, class_of, seen);
    }
    const TimeNs start = thread_cpu_now();
    const std::int64_t asked = namer->counts().asked;
    const std::vector<SegmentClass>& names = namer->name(seen, instances, count);
    done.times.name_ms = ms(thread_cpu_now() - start);
    done.times.asked = namer->counts().asked != asked;
    return &extractor.from_instances(instances, names, seen);
  }

  void understand(const View& view, const LabelFrame* labels) {
    const TimeNs start = thread_cpu_now();
    done = {};
    done.stamp = newest_view = view.stamp();
    correct(view);
    builder.build(view.frame, view.T_world_camera, seen);
    const Extraction* extraction = extract(labels);
    const TimeNs segmented = thread_cpu_now();
    TimeNs associated = segmented;
    if (extraction != nullptr && view.trusted) {
      done.observations = static_cast<int>(extraction->observations.size());
      library.doubt(view.doubted);
      library.observe(*extraction, empty, seen, step);
      library.claim_landmarks(view.landmarks, seen, step);
      journal.note(step.events);
      done.events = std::move(step.events);
      done.beliefs = library.beliefs(step);
      done.owners = std::move(step.owners);
      for (ObjectBelief& belief : done.beliefs) belief.seen = view.stamp();
      for (LandmarkOwner& owner : done.owners) owner.seen = view.stamp();
      associated = thread_cpu_now();
      library.hang_on(view.reference_keyframe, view.stamp());
      integrate(structure, seen, kStructure, Rigid3{}, options.integrate);
      structure_anchors.note(structure, view.reference_keyframe);
      empty.observe(seen);
      if (loose) loose->observe(seen, library);
    }
    const TimeNs end = thread_cpu_now();
    done.times.segment_ms = ms(segmented - start) - done.times.name_ms;
    done.times.associate_ms = ms(associated - segmented);
    done.times.integrate_ms = ms(end - associated);
    done.times.total_ms = ms(end - start);
    list_objects();
  }

  void list_objects() { records = library.standing(); }

  UnderstandingOptions options;
  DepthViewBuilder builder;
  Segmenter segmenter;
  std::unique_ptr<SegmentNamer> namer;  // null: segments stay without names
  Extractor extractor;
  Volume structure;
  StructureAnchors structure_anchors;
  std::optional<LooseSurface> loose;  // none: nobody asked for it
  EmptySpace empty;
  struct Correction {
    TimeNs stamp = 0;  // of the first view in the corrected map
    std::vector<KeyframeMotion> motions;
  };
  std::deque<Correction> corrections;  // of views that wait
  struct ViewOfKeyframe {
    TimeNs first = 0;  // view that hung on it
    std::int64_t keyframe = -1;
  };
  std::vector<ViewOfKeyframe> view_of_keyframe;  // in the order of time
  ObjectLibrary library;
  MeshCache structure_mesh{kMap};
  DepthView seen;
  ImageU8 class_image;
  ImageU16 instances;
  std::vector<SegmentClass> class_of;
  LibraryStep step;
  LabelJoin join;
  Understood done;
  std::vector<ObjectRecord> records;
  WorldJournal journal;
  WorldChange change;
  bool change_out = false;
  TimeNs newest_view = 0, last_change = 0;
};

Understanding::Understanding(const UnderstandingOptions& options, const SensorCalibration& calibration,
                             ClassTable classes, const WorldContent* content, std::unique_ptr<SegmentNamer> namer)
    : impl_(std::make_unique<Impl>(options, calibration, std::move(classes), std::move(namer))) {
  EXPECTS((options.labels == "dnn") == (impl_->namer != nullptr));
  if (content != nullptr) impl_->restore(*content);
}
Understanding::~Understanding() = default;

void Understanding::keep_loose_surface() {
  impl_->loose.emplace(impl_->options.structure, impl_->options.integrate);
}

void Understanding::tell_restored(std::vector<LandmarkOwner>& owners, std::vector<ObjectBelief>& beliefs) const {
  impl_->library.tell_restored(owners, beliefs);
}

void Understanding::add(View&& view) {
  // Kept aside: a view may be dropped while it waits for labels, its corrections may not.
  if (!view.corrections.empty()) impl_->corrections.push_back({view.stamp(), view.corrections});
  impl_->join.add(std::move(view));
}
void Understanding::add(const LabelFrame& labels) {
  impl_->join.add(labels);
}

const Understood* Understanding::step() {
  const LabelledView* next = impl_->join.next();
  if (next == nullptr) return nullptr;
  impl_->understand(next->view, next->labelled ? &next->labels : nullptr);
  return &impl_->done;
}

void Understanding::stop_waiting() {
  impl_->join.stop_waiting();
}

const Understood& Understanding::finish() {
  impl_->done = {};
  impl_->library.finish(impl_->step);
  impl_->journal.note(impl_->step.events);
  impl_->done.events = std::move(impl_->step.events);
  impl_->list_objects();
  return impl_->done;
}

const std::vector<ObjectRecord>& Understanding::objects() const {
  return impl_->records;
}
const LabelCounts& Understanding::labels() const {
  return impl_->join.counts();
}

NamingCounts Understanding::naming() const {
  return impl_->namer == nullptr ? NamingCounts{} : impl_->namer->counts();
}
std::string Understanding::naming_error() const {
  return impl_->namer == nullptr ? std::string() : impl_->namer->last_error();
}

void Understanding::mesh(Mesh& mesh) {
  impl_->structure_mesh.update(impl_->structure);
  impl_->structure_mesh.append_to(mesh, Rigid3{});
  if (impl_->loose) impl_->loose->append_to(mesh, kMap);
  for (const auto& object : impl_->library.objects()) {
    if (object->phase != ObjectPhase::confirmed) continue;
    MeshCache cache(kMap);
    cache.update(object->volume);
    cache.append_to(mesh, object->T_world_volume);
  }
  drop_specks(mesh, std::pow(impl_->options.structure.voxel_size_m, 2));
}

WorldChange* Understanding::take_change() {
  const TimeNs period = from_seconds(impl_->options.change_period_s);
  if (impl_->change_out || impl_->newest_view - impl_->last_change < period) return nullptr;
  return impl_->collect();
}
WorldChange* Understanding::collect_change() {
  return impl_->change_out ? nullptr : impl_->collect();
}
void Understanding::give_back(WorldChange* change) {
  EXPECTS(change == &impl_->change && impl_->change_out);
  impl_->change_out = false;
}

}  // namespace povslam
