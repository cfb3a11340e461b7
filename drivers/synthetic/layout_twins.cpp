// Places that look the same: four bays beside the aisle, the same down to their prints, a rack of three same modules
// opposite. Only what surrounds them tells them apart.
#include <utility>

#include "drivers/synthetic/furniture.hpp"

namespace povslam::synthetic {

namespace {

constexpr int kBays = 4, kModules = 3;
constexpr double kBackWall_m = -5.6;  // y
constexpr Zone kNorth{-6.2, 6.2, 2.6, 4.0}, kWest{-8.3, -6.2, -4.4, 4.4}, kEast{6.2, 8.3, -4.4, 4.4};

// Stands copies of these objects so many pitches further along x. Objects will be numbered in their order.
void repeat(std::vector<Object>& objects, std::size_t begin, std::size_t end, int pitches) {
  for (std::size_t i = begin; i < end; ++i) {
    Object twin = objects[i];
    twin.print = static_cast<std::uint16_t>(i + 1);
    twin.before.position.x() += pitches * kTwinPitch_m;
    twin.after = twin.before;
    objects.push_back(std::move(twin));
  }
}

void stand(std::vector<Object>& objects, Object thing, double x, double y, double yaw) {
  thing.before = thing.after = {true, {x, y, 0.5 * thing.size_m.z()}, yaw};
  objects.push_back(std::move(thing));
}

// Partitions reach from the back wall towards the aisle; a rack stands at the back, a pallet and a box before it.
void add_bays(std::vector<Object>& objects, Random& random) {
  constexpr double kDepth_m = 2.8, kThick_m = 0.1, kFirst_m = -0.5 * kBays * kTwinPitch_m;
  const double middle = kFirst_m + 0.5 * kTwinPitch_m, partition_y = kBackWall_m + 0.1 + 0.5 * kDepth_m;
  const auto wall = [&objects](double length_x_m, double length_y_m, double x, double y) {
    objects.push_back(make_box({length_x_m, length_y_m, kWallHeight_m}, Paint::wall, ClassId::wall, {x, y}, 0.0));
  };
  const std::size_t first = objects.size();
  wall(kThick_m, kDepth_m, kFirst_m, partition_y);
  wall(kTwinPitch_m, 0.06, middle, kBackWall_m + 0.05);
  add_rack(objects, {middle, kBackWall_m + 0.55}, 2.3, 0.9, {1.0}, random);
  stand(objects, make_pallet(random), middle - 0.45, kBackWall_m + 1.6, 0.04);
  stand(objects, make_loose_box(random), middle + 0.65, kBackWall_m + 1.9, 0.3);
  const std::size_t end = objects.size();
  for (int bay = 1; bay < kBays; ++bay) repeat(objects, first, end, bay);
  repeat(objects, first, first + 1, kBays);  // the partition that closes the last one
}

std::vector<Object> furnish(const std::vector<Eigen::Vector2d>& path, Random& random) {
  std::vector<Object> objects;
  add_walls(objects, {Eigen::Vector2d(-8.6, kBackWall_m), Eigen::Vector2d(8.6, 5.6)});
  for (const double side : {-1.0, 1.0}) {
    add_pillar(objects, {side * 4.6, 0.0});
    add_pillar(objects, {side * 6.9, -4.9});
    add_pillar(objects, {side * 6.9, 4.9});
  }
  add_bays(objects, random);
  const std::size_t module = objects.size();
  add_rack(objects, {-0.5 * (kModules - 1) * kTwinPitch_m, 0.0}, kTwinPitch_m - 0.1, 1.0, {-1.0, 1.0}, random);
  const std::size_t end = objects.size();
  for (int i = 1; i < kModules; ++i) repeat(objects, module, end, i);
  add_rack(objects, {0.0, 5.05}, 12.0, 0.9, {-1.0}, random);
  put(objects, make_forklift(), random.chance(0.5) ? kEast : kWest, true, path, random);
  for (int i = 0; i < 4; ++i) {
    put(objects, make_pallet(random), kNorth, true, path, random);
    put(objects, make_loose_box(random), kNorth, false, path, random);
  }
  for (const Zone& zone : {kWest, kEast}) {
    for (int i = 0; i < 4; ++i) put(objects, make_loose_box(random), zone, false, path, random);
  }
  number_objects(objects);
  return objects;
}

}  // namespace

Layout lay_out_twins(const SyntheticOptions& options, const RobotMotion& motion) {
  Random random(mix(options.seed, 3000));
  return {furnish(sample_path(motion.path()), random), {{Eigen::Vector2d(-8.3, -5.3), Eigen::Vector2d(8.3, 5.3)}}};
}

}  // namespace povslam::synthetic
