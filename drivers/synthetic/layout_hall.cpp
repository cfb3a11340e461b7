// A long way round: a block of racks that nothing is seen across, racks along the outer walls. Ends and middles differ.
#include "drivers/synthetic/furniture.hpp"

namespace povslam::synthetic {

namespace {

constexpr double kHallX_m = 15.6, kHallY_m = 6.8;    // half sizes
constexpr double kBlockX_m = 11.2, kBlockY_m = 3.0;  // of the block of racks
constexpr double kRackDepth_m = 0.9;
constexpr Zone kWest{-15.2, -14.2, -5.2, 5.2}, kEast{14.2, 15.2, -5.2, 5.2};

// Back to back along the block, with a wall between them.
void add_block(std::vector<Object>& objects, Random& random) {
  constexpr double kCore_m = 2.0 * (kBlockY_m - kRackDepth_m) - 0.1;
  objects.push_back(
      make_box({2.0 * kBlockX_m, kCore_m, kWallHeight_m}, Paint::wall, ClassId::wall, Eigen::Vector2d::Zero(), 0.0));
  for (const double side : {-1.0, 1.0}) {
    for (const double x : {-7.5, 0.0, 7.5}) {
      add_rack(objects, {x, side * (kBlockY_m - 0.5 * kRackDepth_m)}, 7.2, kRackDepth_m, {side}, random);
    }
  }
}

std::vector<Object> furnish(const std::vector<Eigen::Vector2d>& path, Random& random) {
  std::vector<Object> objects;
  add_walls(objects, {Eigen::Vector2d(-kHallX_m, -kHallY_m), Eigen::Vector2d(kHallX_m, kHallY_m)});
  add_block(objects, random);
  for (const double side : {-1.0, 1.0}) {
    const double y = side * (kHallY_m - 0.05 - 0.5 * kRackDepth_m);
    for (const double x : {-9.0, 0.0, 9.0}) add_rack(objects, {x, y}, 6.0, kRackDepth_m, {-side}, random);
    for (const double x : {-13.0, -4.5, 4.5, 13.0}) add_pillar(objects, {x, side * (kHallY_m - 0.25)});
    for (const double x : {-5.3, -3.7, 3.7, 5.3}) {
      const Zone gap{x - 0.3, x + 0.3, side * 6.1 - 0.25, side * 6.1 + 0.25};
      put(objects, random.chance(0.4) ? make_pallet(random) : make_loose_box(random), gap, false, path, random);
    }
  }
  put(objects, make_forklift(), random.chance(0.5) ? kEast : kWest, true, path, random);
  for (const Zone& zone : {kWest, kEast}) {
    for (int i = 0; i < 4; ++i) put(objects, make_loose_box(random), zone, false, path, random);
    for (int i = 0; i < 2; ++i) put(objects, make_pallet(random), zone, true, path, random);
  }
  number_objects(objects);
  return objects;
}

}  // namespace

Layout lay_out_hall(const SyntheticOptions& options, const RobotMotion& motion) {
  Random random(mix(options.seed, 5000));
  return {furnish(sample_path(motion.path()), random),
          {{Eigen::Vector2d(-kHallX_m + 0.3, -kHallY_m + 0.3), Eigen::Vector2d(kHallX_m - 0.3, kHallY_m - 0.3)}}};
}

}  // namespace povslam::synthetic
