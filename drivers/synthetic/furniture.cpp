#include "drivers/synthetic/furniture.hpp"

#include <algorithm>
#include <utility>

namespace povslam::synthetic {

void add_walls(std::vector<Object>& objects, const Eigen::AlignedBox2d& floor) {
  constexpr double kThick_m = 0.2;
  const Eigen::Vector2d low = floor.min(), high = floor.max(), middle = floor.center();
  const auto wall = [&objects](double length_x_m, double length_y_m, double x, double y) {
    objects.push_back(make_box({length_x_m, length_y_m, kWallHeight_m}, Paint::wall, ClassId::wall, {x, y}, 0.0));
  };
  wall(floor.sizes().x(), kThick_m, middle.x(), low.y() - 0.5 * kThick_m);
  wall(floor.sizes().x(), kThick_m, middle.x(), high.y() + 0.5 * kThick_m);
  wall(kThick_m, floor.sizes().y(), low.x() - 0.5 * kThick_m, middle.y());
  wall(kThick_m, floor.sizes().y(), high.x() + 0.5 * kThick_m, middle.y());
}

void add_pillar(std::vector<Object>& objects, const Eigen::Vector2d& place) {
  objects.push_back(make_box({0.4, 0.4, kWallHeight_m}, Paint::concrete, ClassId::pillar, place, 0.0));
}

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

Object make_loose_box(Random& random) {
  return make_box({random.uniform(0.5, 0.9), random.uniform(0.5, 0.9), random.uniform(0.5, 1.1)}, Paint::carton,
                  ClassId::box, {0.0, 0.0}, 0.0);
}

}  // namespace povslam::synthetic
