// Two rooms: the lap stays in one and never sees the other, which has things of the same kinds and many of the same
// products.
#include <utility>

#include "drivers/synthetic/furniture.hpp"

namespace povslam::synthetic {

namespace {

struct Room {
  Eigen::AlignedBox2d floor;
  double rack_m;  // length of the racks along the walls
};

void furnish(std::vector<Object>& objects, const Room& room, const std::vector<Eigen::Vector2d>& path, Random& random) {
  const Eigen::Vector2d low = room.floor.min(), high = room.floor.max(), middle = room.floor.center();
  add_walls(objects, room.floor);
  for (const double x : {low.x() + 1.7, high.x() - 1.7}) {
    for (const double y : {low.y() + 0.7, high.y() - 0.7}) add_pillar(objects, {x, y});
  }
  for (const double side : {-1.0, 1.0}) add_pillar(objects, {middle.x() + side * 4.45, middle.y()});
  add_rack(objects, middle, 7.2, 1.0, {-1.0, 1.0}, random);
  add_rack(objects, {middle.x(), low.y() + 0.55}, room.rack_m, 0.9, {1.0}, random);
  add_rack(objects, {middle.x(), high.y() - 0.55}, room.rack_m, 0.9, {-1.0}, random);
  const Zone south{low.x() + 2.4, high.x() - 2.4, low.y() + 1.6, low.y() + 3.0};
  const Zone north{low.x() + 2.4, high.x() - 2.4, high.y() - 3.0, high.y() - 1.6};
  const Zone west{low.x() + 0.3, low.x() + 2.4, low.y() + 1.2, high.y() - 1.2};
  const Zone east{high.x() - 2.4, high.x() - 0.3, low.y() + 1.2, high.y() - 1.2};
  put(objects, make_forklift(), random.chance(0.5) ? east : west, true, path, random);
  for (int i = 0; i < 5; ++i) {
    put(objects, make_pallet(random), i % 2 == 0 ? south : north, true, path, random);
    put(objects, make_loose_box(random), i % 2 == 0 ? north : south, false, path, random);
  }
  for (const Zone& zone : {west, east}) {
    for (int i = 0; i < 3; ++i) put(objects, make_loose_box(random), zone, false, path, random);
  }
}

// Every second of the goods from `begin` on becomes one of a kind that stands before it in the list, where it fits.
void share_products(std::vector<Object>& objects, std::size_t begin, Random& random) {
  for (std::size_t i = begin; i < objects.size(); ++i) {
    Object& good = objects[i];
    const auto other = static_cast<std::size_t>(random.below(static_cast<int>(begin)));
    const Object& kind = objects[other];
    if (good.class_id != ClassId::goods || random.chance(0.5)) continue;
    if (kind.class_id != ClassId::goods || kind.size_m.x() > good.size_m.x()) continue;
    const double bottom = good.before.position.z() - 0.5 * good.size_m.z();
    good.size_m = kind.size_m;
    good.parts = kind.parts;
    good.print = static_cast<std::uint16_t>(other + 1);
    good.before.position.z() = bottom + 0.5 * good.size_m.z();
    good.after = good.before;
  }
}

}  // namespace

Layout lay_out_rooms(const SyntheticOptions& options, const RobotMotion& motion) {
  const std::vector<Eigen::Vector2d> path = sample_path(motion.path());
  const Room mapped{{Eigen::Vector2d(-8.6, -5.6), Eigen::Vector2d(8.6, 5.6)}, 12.0};
  const Room unseen{{Eigen::Vector2d(-7.6, 6.4), Eigen::Vector2d(7.6, 16.8)}, 9.6};
  Random random(mix(options.seed, 4000));
  Layout layout;
  furnish(layout.objects, mapped, path, random);
  const std::size_t begin = layout.objects.size();
  furnish(layout.objects, unseen, path, random);
  share_products(layout.objects, begin, random);
  number_objects(layout.objects);
  for (const Room& room : {mapped, unseen}) {
    const Eigen::Vector2d margin(0.3, 0.3);
    layout.floors.emplace_back(room.floor.min() + margin, room.floor.max() - margin);
  }
  return layout;
}

}  // namespace povslam::synthetic
