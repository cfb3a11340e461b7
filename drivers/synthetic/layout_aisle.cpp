// A piece of a warehouse: two aisles about a rack, racks along two walls, pallets and boxes on the floor, a forklift.
#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/synthetic/layout.hpp"

namespace povslam::synthetic {

namespace {

constexpr double kRoomX_m = 8.6, kRoomY_m = 5.6;  // half sizes
constexpr double kWallHeight_m = 3.6;

void add_walls(std::vector<Object>& objects) {
  const double x = 2.0 * kRoomX_m, y = 2.0 * kRoomY_m, thick = 0.2;
  objects.push_back(
      make_box({x, thick, kWallHeight_m}, Paint::wall, ClassId::wall, {0.0, -kRoomY_m - 0.5 * thick}, 0.0));
  objects.push_back(
      make_box({x, thick, kWallHeight_m}, Paint::wall, ClassId::wall, {0.0, kRoomY_m + 0.5 * thick}, 0.0));
  objects.push_back(
      make_box({thick, y, kWallHeight_m}, Paint::wall, ClassId::wall, {-kRoomX_m - 0.5 * thick, 0.0}, 0.0));
  objects.push_back(
      make_box({thick, y, kWallHeight_m}, Paint::wall, ClassId::wall, {kRoomX_m + 0.5 * thick, 0.0}, 0.0));
  for (const double side : {-1.0, 1.0}) {
    objects.push_back(make_box({0.4, 0.4, kWallHeight_m}, Paint::concrete, ClassId::pillar, {side * 4.45, 0.0}, 0.0));
    objects.push_back(make_box({0.4, 0.4, kWallHeight_m}, Paint::concrete, ClassId::pillar, {side * 6.9, -4.9}, 0.0));
    objects.push_back(make_box({0.4, 0.4, kWallHeight_m}, Paint::concrete, ClassId::pillar, {side * 6.9, 4.9}, 0.0));
  }
}

// Posts and three shelves; goods of its own on every shelf, one row for each open side.
void add_rack(std::vector<Object>& objects, const Eigen::Vector2d& place, double length_m, double depth_m,
              const std::vector<double>& open_sides, Random& random) {
  constexpr double kHeight_m = 2.7;
  constexpr double kShelves_m[] = {0.12, 1.0, 1.9};
  Object rack;
  rack.class_id = ClassId::rack;
  rack.size_m = {length_m, depth_m, kHeight_m};
  const int bays = static_cast<int>(length_m / 2.4 + 0.5);
  for (int i = 0; i <= bays; ++i) {
    const double x = length_m * (static_cast<double>(i) / bays - 0.5);
    for (const double side : {-1.0, 1.0}) {
      rack.parts.push_back(
          {{std::clamp(x, -0.5 * length_m + 0.04, 0.5 * length_m - 0.04), side * (0.5 * depth_m - 0.04), 0.0},
           {0.04, 0.04, 0.5 * kHeight_m},
           Paint::steel});
    }
  }
  for (const double shelf : kShelves_m) {
    rack.parts.push_back(
        {{0.0, 0.0, shelf - 0.05 - 0.5 * kHeight_m}, {0.5 * length_m, 0.5 * depth_m - 0.09, 0.05}, Paint::steel});
  }
  rack.before = rack.after = {true, {place.x(), place.y(), 0.5 * kHeight_m}, 0.0};
  objects.push_back(std::move(rack));
  for (const double shelf : kShelves_m) {
    for (const double side : open_sides) {
      for (double x = -0.5 * length_m + 0.15; x < 0.5 * length_m - 0.75;) {
        const Eigen::Vector3d size(random.uniform(0.35, 0.6), random.uniform(0.28, 0.34), random.uniform(0.3, 0.7));
        const double y = side * (0.5 * depth_m - 0.1 - 0.5 * size.y() - random.uniform(0.0, 0.03));
        objects.push_back(
            make_box(size, Paint::goods, ClassId::goods, {place.x() + x + 0.5 * size.x(), place.y() + y}, 0.0, shelf));
        x += size.x() + random.uniform(0.03, 0.25);
      }
    }
  }
}

Object make_pallet(Random& random) {
  const double load = random.uniform(0.4, 0.9), half_height = 0.5 * (0.14 + load);
  Object pallet;
  pallet.class_id = ClassId::pallet;
  pallet.size_m = {1.2, 0.8, 0.14 + load};
  for (const double y : {-0.34, 0.0, 0.34}) {
    pallet.parts.push_back({{0.0, y, 0.05 - half_height}, {0.6, 0.05, 0.05}, Paint::wood});
  }
  pallet.parts.push_back({{0.0, 0.0, 0.12 - half_height}, {0.6, 0.4, 0.02}, Paint::wood});
  const double split = random.uniform(-0.2, 0.2);
  pallet.parts.push_back({{0.5 * (split - 0.57), 0.0, 0.14 + 0.5 * load - half_height},
                          {0.5 * (split + 0.57) - 0.005, 0.37, 0.5 * load},
                          Paint::carton});
  const double second = load * random.uniform(0.6, 1.0);
  pallet.parts.push_back({{0.5 * (split + 0.57), 0.0, 0.14 + 0.5 * second - half_height},
                          {0.5 * (0.57 - split) - 0.005, 0.37, 0.5 * second},
                          Paint::carton});
  return pallet;
}

Object make_forklift() {
  constexpr double kHalf = 1.05;  // of its height
  Object truck;
  truck.class_id = ClassId::forklift;
  truck.size_m = {2.3, 1.0, 2.0 * kHalf};
  truck.parts = {{{-0.4, 0.0, 0.6 - kHalf}, {0.7, 0.5, 0.45}, Paint::truck},
                 {{-0.85, 0.0, 1.25 - kHalf}, {0.25, 0.45, 0.2}, Paint::truck},
                 {{0.38, -0.32, kHalf - kHalf}, {0.06, 0.06, kHalf}, Paint::steel},
                 {{0.38, 0.32, kHalf - kHalf}, {0.06, 0.06, kHalf}, Paint::steel},
                 {{-0.6, 0.42, 1.7 - kHalf}, {0.04, 0.04, 0.3}, Paint::steel},
                 {{-0.6, -0.42, 1.7 - kHalf}, {0.04, 0.04, 0.3}, Paint::steel},
                 {{-0.3, 0.0, 2.03 - kHalf}, {0.5, 0.48, 0.04}, Paint::truck},
                 {{0.8, -0.25, 0.08 - kHalf}, {0.35, 0.06, 0.03}, Paint::steel},
                 {{0.8, 0.25, 0.08 - kHalf}, {0.35, 0.06, 0.03}, Paint::steel}};
  return truck;
}

struct Zone {
  double x_min, x_max, y_min, y_max;
};
constexpr Zone kSouth{-6.2, 6.2, -4.0, -2.6}, kNorth{-6.2, 6.2, 2.6, 4.0}, kWest{-8.3, -6.2, -4.4, 4.4},
    kEast{6.2, 8.3, -4.4, 4.4};

std::optional<Placement> find_place(const Object& object, const Zone& zone, bool square,
                                    const std::vector<Object>& objects, const Object* except,
                                    const std::vector<Eigen::Vector2d>& path, Random& random) {
  for (int attempt = 0; attempt < 200; ++attempt) {
    const double quarter = zone.x_max - zone.x_min > zone.y_max - zone.y_min ? 0.0 : 0.5 * kPi;
    const double yaw = quarter + (square ? random.uniform(-0.12, 0.12) : random.uniform(-kPi, kPi));
    const Placement place{
        true,
        {random.uniform(zone.x_min, zone.x_max), random.uniform(zone.y_min, zone.y_max), 0.5 * object.size_m.z()},
        yaw};
    const Footprint ground = footprint(object, place);
    if (std::abs(ground.center.y()) + 0.3 > kRoomY_m || !is_free(ground, objects, except, path)) continue;
    return place;
  }
  return std::nullopt;
}

enum class Fate { stays, moves, goes, comes };

// Puts one thing into a zone and, if it changes, decides where it is afterwards.
void add_thing(std::vector<Object>& objects, Object thing, const Zone& zone, bool square, Fate fate,
               const std::vector<Eigen::Vector2d>& path, Random& random) {
  const std::optional<Placement> place = find_place(thing, zone, square, objects, nullptr, path, random);
  if (!place) return;
  thing.before = thing.after = *place;
  thing.before.present = fate != Fate::comes;
  thing.after.present = fate != Fate::goes;
  if (fate == Fate::moves) {
    const Zone near{place->position.x() - 1.8, place->position.x() + 1.8, zone.y_min, zone.y_max};
    const Zone there = &zone == &kWest || &zone == &kEast ? zone : near;
    for (int attempt = 0; attempt < 20; ++attempt) {
      const std::optional<Placement> to = find_place(thing, there, square, objects, nullptr, path, random);
      if (!to || (to->position - place->position).norm() < 0.6) continue;
      thing.after = *to;
      break;
    }
  }
  objects.push_back(std::move(thing));
}

Object loose_box(Random& random) {
  return make_box({random.uniform(0.5, 0.9), random.uniform(0.5, 0.9), random.uniform(0.5, 1.1)}, Paint::carton,
                  ClassId::box, {0.0, 0.0}, 0.0);
}

std::vector<Object> furnish(const std::vector<Eigen::Vector2d>& path, Random& random) {
  std::vector<Object> objects;
  add_walls(objects);
  add_rack(objects, {0.0, 0.0}, 7.2, 1.0, {-1.0, 1.0}, random);
  add_rack(objects, {0.0, -5.05}, 12.0, 0.9, {1.0}, random);
  add_rack(objects, {0.0, 5.05}, 12.0, 0.9, {-1.0}, random);
  add_thing(objects, make_forklift(), random.chance(0.5) ? kEast : kWest, true, Fate::moves, path, random);
  const Fate fates[] = {Fate::stays, Fate::moves, Fate::goes, Fate::comes, Fate::stays, Fate::moves};
  for (int i = 0; i < 6; ++i) {
    add_thing(objects, make_pallet(random), i % 2 == 0 ? kSouth : kNorth, true, fates[i], path, random);
    add_thing(objects, loose_box(random), i % 2 == 0 ? kNorth : kSouth, false, fates[(i + 3) % 6], path, random);
  }
  for (const Zone& zone : {kWest, kEast}) {
    for (int i = 0; i < 3; ++i)
      add_thing(objects, loose_box(random), zone, false, i == 0 ? Fate::moves : Fate::stays, path, random);
  }
  number_objects(objects);
  return objects;
}

}  // namespace

std::vector<Object> lay_out_aisle(const SyntheticOptions& options, const RobotMotion& motion, Watch& watch) {
  const std::vector<Eigen::Vector2d> path = sample_path(motion.path());
  constexpr int kAttempts = 40;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    Random random(mix(options.seed, 2000 + static_cast<std::uint64_t>(attempt)));
    std::vector<Object> objects = furnish(path, random);
    if (time_changes(objects, motion, watch)) return objects;
  }
  return {};
}

}  // namespace povslam::synthetic
