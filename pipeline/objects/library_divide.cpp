// What was taken for one thing and is several, side by side, is divided where views told them apart.
#include <algorithm>

#include "pipeline/objects/library.hpp"
#include "pipeline/objects/part_change.hpp"

namespace povslam {
namespace {

constexpr double kClear_m = 0.02, kMin_m = 0.1;
constexpr std::size_t kMinPoints = 8;

// Whether it has surface to speak of beyond the plane.
bool reaches_beyond(const MapObject& object, const FencePlane& plane) {
  std::size_t beyond = 0;
  double most_m = 0.0;
  for (const SurfacePoint& point : object.surface) {
    const double d = plane.distance_m(point.p_volume.cast<double>());
    beyond += d > kClear_m ? 1 : 0;
    most_m = std::max(most_m, d);
  }
  return beyond >= kMinPoints && most_m > kMin_m;
}

}  // namespace

// What one view cannot tell from noise, many together can: looked for in what is wider than its kind.
void ObjectLibrary::look_for_groove(MapObject& object, std::uint16_t owner, const DepthView& view) {
  constexpr double kWider_m = 0.08;
  const auto front = front_side(object.seen);
  const double widest = widest_m(object);
  const bool wide = front && widest > 0.0 && object.seen.box.size_m[front->along()] > widest + kWider_m;
  if (!wide || class_of(object).one_piece) {
    object.profile.reset();
    return;
  }
  if (!object.profile) object.profile.emplace(object.seen, *front);
  object.profile->add(view, owner, object.T_world_volume, integrate_options_.depth_sigma_quadratic_per_m);
  const auto at = object.profile->groove();
  if (!at) return;
  add_firm_fence(object, *at, object.profile->along());
  object.profile.reset();
}

// Leaves in the object what is on its centre's side; returns the rest.
std::unique_ptr<MapObject> ObjectLibrary::cut_at(const FencePlane& plane, MapObject& object) {
  auto part = std::make_unique<MapObject>(next_id_, object.volume.options());
  part->volume = cut_out(
      object.volume, [&](const Eigen::Vector3f& p_volume) { return plane.distance_m(p_volume.cast<double>()) > 0.0; });
  part->phase = object.phase;
  part->class_votes = object.class_votes;
  part->class_binds = object.class_binds;
  part->belief = object.belief;
  part->T_world_volume = object.T_world_volume;
  part->first_seen = object.first_seen;
  part->last_seen = object.last_seen;
  part->keyframe = object.keyframe;
  part->observations = object.observations;
  part->looks = object.looks;
  part->announced = object.announced;
  part->fences = object.fences;
  reshape(*part);
  reshape(object);
  return part;
}

void ObjectLibrary::divide(const std::vector<MapObject*>& reach, LibraryStep& step) {
  constexpr double kKnownAlready = 0.3;
  for (MapObject* object : reach) {
    for (const FencePlane& plane : known_fences(*object)) {
      if (!reaches_beyond(*object, plane)) continue;
      auto part = cut_at(plane, *object);
      const Box box = part->box_world();
      const bool known = std::ranges::any_of(objects_, [&](const auto& other) {
        return other.get() != object && other->class_id() == object->class_id() &&
               overlap(box, other->box_world()).of_smaller > kKnownAlready;
      });
      if (known || std::ssize(part->surface) < options_.extract.min_points / 2) continue;
      ++next_id_;
      step.changed.push_back(part->id);
      objects_.push_back(std::move(part));
    }
  }
}

}  // namespace povslam
