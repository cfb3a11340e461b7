// What stands in a warehouse: walls, racks with their goods, pallets, a forklift. Ids and places on the floor are
// still to be given unless said otherwise.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "drivers/synthetic/layout.hpp"

namespace povslam::synthetic {

inline constexpr double kWallHeight_m = 3.6;

// Around the floor, in the order -y, +y, -x, +x.
void add_walls(std::vector<Object>& objects, const Eigen::AlignedBox2d& floor);
void add_pillar(std::vector<Object>& objects, const Eigen::Vector2d& place);

// Posts and three shelves along x; goods of its own on every shelf, one row for each open side (-1, +1: of y).
void add_rack(std::vector<Object>& objects, const Eigen::Vector2d& place, double length_m, double depth_m,
              const std::vector<double>& open_sides, Random& random);

Object make_pallet(Random& random);  // loaded
Object make_forklift();
Object make_loose_box(Random& random);

}  // namespace povslam::synthetic
