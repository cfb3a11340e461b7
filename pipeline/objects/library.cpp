#include "pipeline/objects/library.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/base/time.hpp"
#include "pipeline/objects/state.hpp"

namespace povslam {
namespace {

bool may_be_seen(const Box& box, const DepthView& view, double max_depth_m) {
  const Eigen::Vector3d p = view.T_world_camera.inverse() * box.center;
  const double radius = 0.5 * box.size_m.norm() + 0.1;
  if (p.z() < -radius || p.z() - radius > max_depth_m) return false;
  const double z = std::max(p.z(), 0.1);
  const double slack_x = radius / view.camera.fx * view.camera.fx / z, slack_y = slack_x;
  const double right = (view.camera.width - view.camera.cx) / view.camera.fx, left = view.camera.cx / view.camera.fx;
  const double down = (view.camera.height - view.camera.cy) / view.camera.fy, up = view.camera.cy / view.camera.fy;
  return p.x() / z < right + slack_x && p.x() / z > -left - slack_x && p.y() / z < down + slack_y &&
         p.y() / z > -up - slack_y;
}

double look_weight(double depth_m, const IntegrateOptions& options) {
  const double sigma = std::hypot(options.depth_sigma_floor_m, options.depth_sigma_quadratic_per_m * depth_m * depth_m);
  return std::min(1.0, kGoodSigma_m * kGoodSigma_m / (sigma * sigma));
}

double farthest_m(const DepthView& view) {
  float most = 0.0F;
  for (const float z : view.depth_m.pixels()) most = std::max(most, z);
  return static_cast<double>(most);
}

EventDeskOptions desk_options(const LifeOptions& life) {
  EventDeskOptions options;
  options.hold = from_seconds(life.hold_s);
  options.settle = from_seconds(life.settle_s);
  return options;
}

}  // namespace

ObjectLibrary::ObjectLibrary(const ObjectOptions& options, const VolumeOptions& volume,
                             const IntegrateOptions& integrate, ClassTable classes)
    : options_(options),
      volume_options_(volume),
      integrate_options_(integrate),
      classes_(std::move(classes)),
      unknown_class_(make_class(0, "unknown", ClassKind::semi_static)),
      desk_(desk_options(options.life), 0,
            [this](std::int64_t came, std::int64_t gone) { renamed_.emplace_back(came, gone); }) {}

const ObjectClass& ObjectLibrary::class_of(const MapObject& object) const {
  const ObjectClass* row = classes_.find(object.class_id());
  return row == nullptr || row->id == unknown_class_.id ? unknown_class_ : *row;
}

std::vector<MapObject*> ObjectLibrary::in_reach(const DepthView& view) const {
  std::vector<MapObject*> reach;
  const double max_depth_m = farthest_m(view);
  for (const auto& object : objects_) {
    if (may_be_seen(object->box_world(), view, max_depth_m)) reach.push_back(object.get());
  }
  return reach;
}

void ObjectLibrary::observe(const Extraction& extraction, const EmptySpace& empty, DepthView& view, LibraryStep& step) {
  step = {};
  const std::vector<MapObject*> reach = in_reach(view);
  const std::vector<const MapObject*> known(reach.begin(), reach.end());
  std::vector<SurfaceLook> looks;
  std::vector<Standing> stands;
  for (const MapObject* object : reach) {
    looks.push_back(look_at(object->surface, view, object->T_world_volume, options_.life.margin_m));
    stands.push_back(standing(looks.back(), *object));
  }
  Association association = associate(extraction.observations, known, stands, options_.associate);
  mark_owners(association, extraction.observations, known, view);

  std::vector<const Match*> match_of(reach.size(), nullptr);
  object_of_owner_.clear();
  integrated_.clear();
  for (const Match& match : association.matches) {
    match_of[static_cast<std::size_t>(match.object)] = &match;
    object_of_owner_[match.owner] = reach[static_cast<std::size_t>(match.object)]->id;
  }
  for (std::size_t j = 0; j < reach.size(); ++j) {
    MapObject& object = *reach[j];
    const SurfaceLook& look = looks[j];
    if (match_of[j] != nullptr) {
      take(*match_of[j], object, extraction, view, look);
      confirm(object, empty);
    } else {
      miss(object, look, view.stamp);
    }
    step.changed.push_back(object.id);
  }
  for (std::size_t u = 0; u < association.unclaimed.size(); ++u) {
    const Observation& unclaimed = extraction.observations[static_cast<std::size_t>(association.unclaimed[u])];
    if (!inside_known(unclaimed, reach, stands)) start(unclaimed, association.unclaimed_owner[u], view);
  }
  learn_rows();
  learn_depths(reach);
  divide(reach, step);
  merge_duplicates(association, reach, step);
  join_halves(association, reach, view, step);
  learn_extents();
  for (const auto& object : objects_) {
    if (object->last_seen == view.stamp) settle(*object);
  }
  absorb_fragments(view.stamp, step);
  drop_unbelieved(view.stamp, step);
  refresh_waiting(view.stamp);
  desk_.decide(view.stamp, step.events);
  for (const auto& [came, gone] : std::exchange(renamed_, {})) rename(came, gone, step);
}

bool ObjectLibrary::contradicted(const SurfaceLook& look, const MapObject& object) const {
  const int enough = std::min<int>(options_.life.visible_points, static_cast<int>(object.surface.size()) / 2);
  return look.seen_through >= std::max(enough, 5) &&
         look.seen_through > options_.life.visible_share * (look.agree + look.seen_through);
}

Standing ObjectLibrary::standing(const SurfaceLook& look, const MapObject& object) const {
  if (!contradicted(look, object)) return Standing::whole;
  const double share =
      static_cast<double>(look.seen_through) / static_cast<double>(std::max<std::size_t>(1, object.surface.size()));
  const bool gone = share >= 0.5 * options_.life.visible_share && look.seen_through >= look.agree;
  return gone ? Standing::gone : Standing::broken;
}

void ObjectLibrary::take(const Match& match, MapObject& object, const Extraction& extraction, const DepthView& view,
                         const SurfaceLook& look) {
  const Observation& first = extraction.observations[static_cast<std::size_t>(match.observations[0])];
  object.class_votes[first.class_id] += first.votes;
  object.class_binds = first.class_binds;
  if (match.known_surface) {
    BeliefOptions belief = options_.belief;
    double noise = 0.0;
    for (const float sigma : first.sigma_m) noise += static_cast<double>(sigma);
    belief.tau_m = std::hypot(belief.tau_m, noise / static_cast<double>(first.sigma_m.size()));
    const double change_m = belief.lambda_diff * match.registration.mean_distance_m;
    object.belief = observe_change(object.belief, change_m, class_of(object), belief).belief;
  }
  if (contradicted(look, object)) {  // part of it is gone: its shape must not be painted over
    doubt_part(match, object, extraction, view);
    return;
  }
  object.part_belief.reset();
  if (std::ranges::find(doubted_, object.id) != doubted_.end()) return;
  std::vector<const Observation*> seen;
  for (const int i : match.observations) seen.push_back(&extraction.observations[static_cast<std::size_t>(i)]);
  note_fences(object, seen, view.stamp);
  object.last_seen = view.stamp;
  object.first_absent = object.last_absent = std::nullopt;
  ++object.observations;
  integrate(object.volume, view, match.owner, object.T_world_volume, integrate_options_);
  integrated_.push_back(match.owner);
  object.looks += look_weight(first.median_depth_m, integrate_options_);
  reshape(object);
  object.hidden.look(object.seen, object.T_world_volume, view);
  look_for_groove(object, match.owner, view);
}

// Absence is believed where the camera saw through the object's place; what still stands and was only not told apart
// is not absent (see the design's method 1.5).
void ObjectLibrary::miss(MapObject& object, const SurfaceLook& look, TimeNs now) {
  if (standing(look, object) != Standing::gone) {
    if (look.agree > 2 * (look.seen_through + 10) && object.phase == ObjectPhase::confirmed) object.last_seen = now;
    return;
  }
  if (!object.first_absent) object.first_absent = now;
  object.last_absent = now;
  object.belief = observe_change(object.belief, options_.belief.max_change_m, class_of(object), options_.belief).belief;
}

void ObjectLibrary::start(const Observation& observation, std::uint16_t owner, const DepthView& view) {
  if (observation.median_depth_m > options_.life.new_within_m) return;
  const ObjectClass* row = classes_.find(observation.class_id);
  const ObjectClass& object_class = row == nullptr ? unknown_class_ : *row;
  const double extent = observation.box.size_m.maxCoeff();
  if (extent < object_class.min_extent_m || extent > object_class.max_extent_m) return;
  auto object = std::make_unique<MapObject>(next_id_++, volume_options_);
  object->class_votes[observation.class_id] = observation.votes;
  object->class_binds = observation.class_binds;
  object->belief = initial_belief(object_class, options_.belief);
  object->T_world_volume = upright(observation.box.center, observation.box.yaw);
  object->first_seen = object->last_seen = view.stamp;
  object->observations = 1;
  integrate(object->volume, view, owner, object->T_world_volume, integrate_options_);
  object->looks = look_weight(observation.median_depth_m, integrate_options_);
  reshape(*object);
  if (std::ssize(object->surface) < options_.extract.min_points / 2) return;
  const Observation* seen = &observation;
  note_fences(*object, {&seen, 1}, view.stamp);
  object_of_owner_[owner] = object->id;
  objects_.push_back(std::move(object));
}

// What lies within an object that still stands is a part of it that was not told to be.
bool ObjectLibrary::inside_known(const Observation& observation, const std::vector<MapObject*>& reach,
                                 std::span<const Standing> stands) const {
  for (std::size_t j = 0; j < reach.size(); ++j) {
    const MapObject& object = *reach[j];
    if (stands[j] != Standing::whole || object.phase != ObjectPhase::confirmed || object.first_absent) continue;
    const bool alike = !observation.class_binds || object.class_id() == observation.class_id;
    if (alike && lies_within(observation, object.box_world())) return true;
  }
  return false;
}

PlaceChange ObjectLibrary::change_of(const MapObject& object, TimeNs now) const {
  PlaceChange change;
  const Box box = object.box_world();
  change.object = object.id;
  change.class_name = class_of(object).name;
  change.named = object.class_id() != kUnnamedThing;
  change.place = {box.center, box.yaw};
  change.size_m = box.size_m;
  change.whole = seen_whole(object);
  change.consistency = object.belief.expected_consistency();
  change.evidence.first_present = object.first_seen;
  change.evidence.last_present = object.last_seen;
  change.appearance = appearance_of(object.volume);
  change.decided = now;
  change.keyframe = object.keyframe;
  return change;
}

void ObjectLibrary::finish(LibraryStep& step) {
  step = {};
  TimeNs now = 0;
  for (const auto& object : objects_) now = std::max(now, object->last_seen);
  desk_.decide_all(now, step.events);
  for (const auto& [came, gone] : std::exchange(renamed_, {})) rename(came, gone, step);
}

}  // namespace povslam
