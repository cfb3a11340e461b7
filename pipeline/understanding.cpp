#include "pipeline/understanding.hpp"

#include <map>
#include <utility>

#include "pipeline/base/time.hpp"
#include "pipeline/objects/label_join.hpp"
#include "pipeline/objects/library.hpp"
#include "pipeline/objects/loose_surface.hpp"
#include "pipeline/objects/restore_block.hpp"
#include "pipeline/objects/world_journal.hpp"

namespace povslam {
namespace {

constexpr double kMeshWeight = 0.1;  // looks: one from 3 m is a fifth

float ms(TimeNs span) {
  return static_cast<float>(to_ms(span));
}

// Segments have no class but that of things.
ClassTable classes_for(const UnderstandingOptions& options, ClassTable classes) {
  return options.labels == "geometric" ? geometric_classes() : std::move(classes);
}

LabelJoinOptions join_options(const UnderstandingOptions& options, const SensorCalibration& calibration) {
  LabelJoinOptions join;
  join.max_latency_s = options.labels == "geometric" ? 0.0 : options.label_max_latency_s;
  join.period_s = 1.0 / calibration.fps;
  join.width = calibration.camera.width;
  join.height = calibration.camera.height;
  return join;
}

}  // namespace

struct Understanding::Impl {
  Impl(const UnderstandingOptions& its_options, const SensorCalibration& calibration, ClassTable classes)
      : options(its_options),
        builder(calibration.camera, options.view),
        segmenter(calibration.camera, options.segment),
        extractor(options.objects.extract, options.integrate.depth_sigma_quadratic_per_m),
        structure(options.structure),
        loose(options.structure, options.integrate),
        empty(options.empty),
        library(options.objects, options.object, options.integrate, classes_for(options, std::move(classes))),
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

  bool geometric() const { return options.labels == "geometric"; }

  const Extraction* extract(const LabelFrame* labels) {
    if (labels != nullptr) {
      builder.rectify_labels(*labels, class_image);
      return &extractor.from_classes(class_image, library.classes(), seen);
    }
    if (!geometric()) return nullptr;
    const std::vector<Segment>& segments = segmenter.segment(seen, instances);
    const std::vector<std::uint16_t> class_of(segments.size(), kGeometricObject);
    return &extractor.from_instances(instances, class_of, seen);
  }

  void understand(const View& view, const LabelFrame* labels) {
    const TimeNs start = thread_cpu_now();
    done = {};
    done.stamp = newest_view = view.stamp();
    builder.build(view.frame, view.T_world_camera, seen);
    const Extraction* extraction = extract(labels);
    const TimeNs segmented = thread_cpu_now();
    TimeNs associated = segmented;
    if (extraction != nullptr && view.trusted) {
      done.observations = static_cast<int>(extraction->observations.size());
      library.observe(*extraction, empty, seen, step);
      library.claim_landmarks(view.landmarks, seen, step);
      journal.note(step.events);
      done.events = std::move(step.events);
      done.owners = std::move(step.owners);
      associated = thread_cpu_now();
      integrate(structure, seen, kStructure, Rigid3{}, options.integrate);
      empty.observe(seen);
      loose.observe(seen, library);
    }
    const TimeNs end = thread_cpu_now();
    done.times = {ms(segmented - start), ms(associated - segmented), ms(end - associated), ms(end - start)};
    list_objects();
  }

  void list_objects() {
    records.clear();
    for (const auto& object : library.objects()) {
      if (object->phase == ObjectPhase::confirmed) records.push_back(library.record_of(*object));
    }
  }

  UnderstandingOptions options;
  DepthViewBuilder builder;
  Segmenter segmenter;
  Extractor extractor;
  Volume structure;
  LooseSurface loose;
  EmptySpace empty;
  ObjectLibrary library;
  MeshCache structure_mesh{kMeshWeight};
  DepthView seen;
  ImageU8 class_image;
  ImageU16 instances;
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
                             ClassTable classes, const WorldContent* content)
    : impl_(std::make_unique<Impl>(options, calibration, std::move(classes))) {
  if (content != nullptr) impl_->restore(*content);
}
Understanding::~Understanding() = default;

void Understanding::add(View&& view) {
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

void Understanding::mesh(Mesh& mesh) {
  impl_->structure_mesh.update(impl_->structure);
  impl_->structure_mesh.append_to(mesh, Rigid3{});
  impl_->loose.append_to(mesh, kMeshWeight);
  for (const auto& object : impl_->library.objects()) {
    if (object->phase != ObjectPhase::confirmed) continue;
    MeshCache cache(kMeshWeight);
    cache.update(object->volume);
    cache.append_to(mesh, object->T_world_volume);
  }
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
