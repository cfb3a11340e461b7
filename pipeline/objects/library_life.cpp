// When a thing becomes an object, and when it is none any more.
#include <algorithm>

#include "pipeline/base/time.hpp"
#include "pipeline/objects/library.hpp"

namespace povslam {
namespace {

constexpr TimeNs kEmptyBefore = kNsPerSecond;
constexpr std::size_t kOldPlaces = 256;

bool is_hardly_seen(const MapObject& object) {
  constexpr double kLooks = 0.25;  // seven views from 4.5 m, two from 3 m
  return object.looks < kLooks;
}

// From afar an edge of a thing known by its other sides looks like a thing of its own; so does what shows of a thing
// past another.
bool is_sliver(const MapObject& object) {
  constexpr double kNarrow_m = 0.2, kEdge_m = 0.1;
  const double width_m = object.box.size_m.head<2>().maxCoeff();
  return width_m < kNarrow_m && (is_hardly_seen(object) || (width_m < kEdge_m && !seen_whole(object)));
}

// It went before the camera's eyes and had not stood there for long: somebody walking, a vehicle driving by. Nobody put
// it there, nobody took it away.
bool was_passing(const MapObject& object) {
  constexpr TimeNs kWatched = kNsPerSecond, kStood = 3 * kNsPerSecond;
  return object.first_absent && *object.first_absent - object.last_seen < kWatched &&
         object.last_seen - object.first_seen < kStood;
}

}  // namespace

// Where another thing stood, or was seen not to stand any more, nothing else can have stood with it.
bool ObjectLibrary::stands_in_old_place(const MapObject& object) const {
  constexpr double kEnough = 0.15;
  const Box box = object.box_world();
  const auto in_the_way = [&](const Box& place) { return overlap(box, place).of_smaller > kEnough; };
  return std::ranges::any_of(
             old_places_,
             [&](const OldPlace& old) { return old.last_present < object.first_seen && in_the_way(old.box); }) ||
         std::ranges::any_of(objects_, [&](const auto& other) {
           return other->first_absent && other->phase == ObjectPhase::confirmed &&
                  other->last_seen < object.first_seen && in_the_way(other->box_world());
         });
}

// Of its surface, what stands in space that was seen empty before it was first seen.
double ObjectLibrary::share_that_came(const MapObject& object, const EmptySpace& empty, Evidence& evidence) const {
  int came = 0, points = 0;
  for (const SurfacePoint& point : object.surface) {
    constexpr float kInside_m = 0.1F;  // a cell of which all lies within the object
    const auto seen = empty.at(object.T_world_volume * (point.p_volume - kInside_m * point.normal).cast<double>());
    ++points;
    if (!seen || seen->times < 3 || seen->last >= object.first_seen) continue;
    if (seen->first > object.first_seen - kEmptyBefore) continue;
    ++came;
    evidence.first_absent = std::min(evidence.first_absent.value_or(seen->first), seen->first);
    evidence.last_absent = std::max(evidence.last_absent.value_or(seen->last), seen->last);
  }
  return static_cast<double>(came) / std::max(points, 1);
}

void ObjectLibrary::confirm(MapObject& object, const EmptySpace& empty) {
  if (object.phase != ObjectPhase::tentative || object.observations < options_.life.confirm_views) return;
  if (!makes_objects(class_of(object).kind)) return;  // named so after it was begun
  if (std::ssize(object.surface) < options_.extract.min_points || is_sliver(object)) return;
  object.phase = ObjectPhase::confirmed;
  Evidence evidence;
  object.announced = true;
  PlaceChange change = change_of(object, object.last_seen);
  change.probability = object.belief.expected_consistency();
  if (share_that_came(object, empty, evidence) < options_.life.empty_share && !stands_in_old_place(object)) {
    desk_.found(std::move(change));
    return;
  }
  change.evidence.first_absent = evidence.first_absent;
  change.evidence.last_absent = evidence.last_absent;
  desk_.came(std::move(change));
}

// What was hardly seen, from afar, may have been a side of a thing that was made out later, from nearer: not in its
// place by centimetres, it is seen through and did not go.
const MapObject* ObjectLibrary::same_thing_better_known(const MapObject& object) const {
  constexpr double kBetter = 4.0, kWithin = 0.3;
  const Box box = object.box_world();
  const auto same = std::ranges::find_if(objects_, [&](const auto& other) {
    return other.get() != &object && other->phase == ObjectPhase::confirmed && !other->first_absent &&
           other->class_id() == object.class_id() && other->looks > kBetter * object.looks && is_hardly_seen(object) &&
           overlap(box, other->box_world()).of_smaller > kWithin;
  });
  return same == objects_.end() ? nullptr : same->get();
}

void ObjectLibrary::drop_unbelieved(TimeNs now, LibraryStep& step) {
  std::vector<std::int64_t> dropped, heirs;
  for (const auto& object : objects_) {
    const bool tentative = object->phase == ObjectPhase::tentative;
    const bool forgotten = tentative && now - object->last_seen > from_seconds(options_.life.forget_tentative_s);
    const bool unbelieved = object->belief.expected_consistency() < options_.belief.remove_below;
    const bool no_object = !tentative && !makes_objects(class_of(*object).kind);
    if (!forgotten && !unbelieved && !no_object) continue;
    dropped.push_back(object->id);
    const MapObject* same = same_thing_better_known(*object);
    heirs.push_back(same != nullptr ? same->id : object->last_absent ? LandmarkOwner::kGone : LandmarkOwner::kNobody);
    desk_.withdraw(object->id);
    if (tentative || no_object || !object->last_absent || same != nullptr || was_passing(*object)) continue;
    PlaceChange change = change_of(*object, now);
    change.probability = 1.0 - object->belief.expected_consistency();
    change.evidence.first_absent = object->first_absent;
    change.evidence.last_absent = object->last_absent;
    desk_.gone(std::move(change));
    remember_place(*object);
  }
  for (std::size_t i = 0; i < dropped.size(); ++i) erase(dropped[i], heirs[i], step);
}

void ObjectLibrary::remember_place(const MapObject& object) {
  old_places_.push_back({object.box_world(), object.last_seen, object.keyframe});
  if (old_places_.size() > kOldPlaces) old_places_.erase(old_places_.begin());
}

// A thing is often told to have come when little of it was seen: what it is like shows while its event waits.
void ObjectLibrary::refresh_waiting(TimeNs now) {
  if (!desk_.any_gone()) return;
  for (const std::int64_t id : desk_.waiting()) {
    const auto known = std::ranges::find(objects_, id, [](const auto& object) { return object->id; });
    if (known != objects_.end()) desk_.refresh(change_of(**known, now));
  }
}

}  // namespace povslam
