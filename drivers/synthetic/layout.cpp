#include "drivers/synthetic/layout.hpp"

#include <algorithm>
#include <utility>

namespace povslam::synthetic {

namespace {

constexpr double kPersonSpeed_mps = 0.8;

Object make_person(const Walk& walk) {
  Object person;
  person.class_id = ClassId::person;
  person.size_m = {0.34, 0.5, 1.74};
  person.parts = {{{0.0, 0.0, -0.13}, {0.15, 0.25, 0.74}, Paint::cloth},
                  {{0.02, 0.0, 0.74}, {0.11, 0.09, 0.13}, Paint::cloth}};
  person.walk = walk;
  return person;
}

}  // namespace

Object make_box(const Eigen::Vector3d& size_m, Paint paint, ClassId class_id, const Eigen::Vector2d& place, double yaw,
                double bottom_m) {
  Object box;
  box.class_id = class_id;
  box.size_m = size_m;
  box.parts = {{Eigen::Vector3d::Zero(), 0.5 * size_m, paint}};
  box.before = {true, {place.x(), place.y(), bottom_m + 0.5 * size_m.z()}, yaw};
  box.after = box.before;
  return box;
}

void number_objects(std::vector<Object>& objects) {
  std::uint16_t id = 0;
  for (Object& object : objects) object.id = ++id;
}

bool is_free(const Footprint& place, const std::vector<Object>& objects, const Object* except,
             const std::vector<Eigen::Vector2d>& path) {
  for (const Object& other : objects) {
    if (&other == except) continue;
    for (const Placement& there : {other.before, other.after}) {
      if (there.present && overlap(place, footprint(other, there), kGap_m)) return false;
    }
  }
  return clearance_m(place, path) >= kPathClearance_m;
}

std::optional<Placement> find_place(const Object& object, const Zone& zone, bool square,
                                    const std::vector<Object>& objects, const std::vector<Eigen::Vector2d>& path,
                                    Random& random) {
  for (int attempt = 0; attempt < 200; ++attempt) {
    const double quarter = zone.x_max - zone.x_min > zone.y_max - zone.y_min ? 0.0 : 0.5 * kPi;
    const double yaw = quarter + (square ? random.uniform(-0.12, 0.12) : random.uniform(-kPi, kPi));
    const Placement place{
        true,
        {random.uniform(zone.x_min, zone.x_max), random.uniform(zone.y_min, zone.y_max), 0.5 * object.size_m.z()},
        yaw};
    if (is_free(footprint(object, place), objects, nullptr, path)) return place;
  }
  return std::nullopt;
}

void put(std::vector<Object>& objects, Object thing, const Zone& zone, bool square,
         const std::vector<Eigen::Vector2d>& path, Random& random) {
  const std::optional<Placement> place = find_place(thing, zone, square, objects, path, random);
  if (!place) return;
  thing.before = thing.after = *place;
  objects.push_back(std::move(thing));
}

void add_movers(std::vector<Object>& objects, const SyntheticOptions& options, const LapPath& path,
                const Eigen::AlignedBox2d& floor) {
  Random random(mix(options.seed, 404));
  const std::vector<Eigen::Vector2d> samples = sample_path(path);
  const std::vector<Object> standing = objects;
  for (int attempt = 0, added = 0; attempt < 20000 && added < options.movers; ++attempt) {
    const Eigen::Vector2d middle(random.uniform(floor.min().x(), floor.max().x()),
                                 random.uniform(floor.min().y(), floor.max().y()));
    const double length = random.uniform(1.0, 4.0), yaw = 0.5 * kPi * random.below(4);
    if (!is_free({middle, {0.5 * length + 0.3, 0.3}, yaw}, standing, nullptr, samples)) continue;
    const SinCos direction = sin_cos(yaw);
    const Eigen::Vector2d half = 0.5 * length * Eigen::Vector2d(direction.cos, direction.sin);
    const Eigen::Vector2d from = middle - half, to = middle + half;
    objects.push_back(
        make_person({{from.x(), from.y(), 0.87}, {to.x(), to.y(), 0.87}, kPersonSpeed_mps, random.uniform(-9.0, 0.0)}));
    ++added;
  }
  number_objects(objects);
}

}  // namespace povslam::synthetic
