// A piece of a warehouse: two aisles about a rack, racks along two walls, pallets and boxes on the floor, a forklift.
#include <utility>

#include "drivers/synthetic/furniture.hpp"

namespace povslam::synthetic {

namespace {

constexpr Zone kSouth{-6.2, 6.2, -4.0, -2.6}, kNorth{-6.2, 6.2, 2.6, 4.0}, kWest{-8.3, -6.2, -4.4, 4.4},
    kEast{6.2, 8.3, -4.4, 4.4};

enum class Fate { stays, moves, goes, comes };

// Puts one thing into a zone and, if it changes, decides where it is afterwards.
void add_thing(std::vector<Object>& objects, Object thing, const Zone& zone, bool square, Fate fate,
               const std::vector<Eigen::Vector2d>& path, Random& random) {
  const std::optional<Placement> place = find_place(thing, zone, square, objects, path, random);
  if (!place) return;
  thing.before = thing.after = *place;
  thing.before.present = fate != Fate::comes;
  thing.after.present = fate != Fate::goes;
  if (fate == Fate::moves) {
    const Zone near{place->position.x() - 1.8, place->position.x() + 1.8, zone.y_min, zone.y_max};
    const Zone there = &zone == &kWest || &zone == &kEast ? zone : near;
    for (int attempt = 0; attempt < 20; ++attempt) {
      const std::optional<Placement> to = find_place(thing, there, square, objects, path, random);
      if (!to || (to->position - place->position).norm() < 0.6) continue;
      thing.after = *to;
      break;
    }
  }
  objects.push_back(std::move(thing));
}

std::vector<Object> furnish(const std::vector<Eigen::Vector2d>& path, Random& random) {
  std::vector<Object> objects;
  add_walls(objects, {Eigen::Vector2d(-8.6, -5.6), Eigen::Vector2d(8.6, 5.6)});
  for (const double side : {-1.0, 1.0}) {
    add_pillar(objects, {side * 4.45, 0.0});
    add_pillar(objects, {side * 6.9, -4.9});
    add_pillar(objects, {side * 6.9, 4.9});
  }
  add_rack(objects, {0.0, 0.0}, 7.2, 1.0, {-1.0, 1.0}, random);
  add_rack(objects, {0.0, -5.05}, 12.0, 0.9, {1.0}, random);
  add_rack(objects, {0.0, 5.05}, 12.0, 0.9, {-1.0}, random);
  add_thing(objects, make_forklift(), random.chance(0.5) ? kEast : kWest, true, Fate::moves, path, random);
  const Fate fates[] = {Fate::stays, Fate::moves, Fate::goes, Fate::comes, Fate::stays, Fate::moves};
  for (int i = 0; i < 6; ++i) {
    add_thing(objects, make_pallet(random), i % 2 == 0 ? kSouth : kNorth, true, fates[i], path, random);
    add_thing(objects, make_loose_box(random), i % 2 == 0 ? kNorth : kSouth, false, fates[(i + 3) % 6], path, random);
  }
  for (const Zone& zone : {kWest, kEast}) {
    for (int i = 0; i < 3; ++i)
      add_thing(objects, make_loose_box(random), zone, false, i == 0 ? Fate::moves : Fate::stays, path, random);
  }
  number_objects(objects);
  return objects;
}

}  // namespace

Layout lay_out_aisle(const SyntheticOptions& options, const RobotMotion& motion, Watch& watch) {
  const std::vector<Eigen::Vector2d> path = sample_path(motion.path());
  constexpr int kAttempts = 40;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    Random random(mix(options.seed, 2000 + static_cast<std::uint64_t>(attempt)));
    std::vector<Object> objects = furnish(path, random);
    if (time_changes(objects, motion, watch))
      return {std::move(objects), {{Eigen::Vector2d(-8.3, -5.3), Eigen::Vector2d(8.3, 5.3)}}};
  }
  return {};
}

}  // namespace povslam::synthetic
