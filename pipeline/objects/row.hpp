// What is wont to be of things in one row, on shelves or along a wall. Of what has no sure class the row says more than
// all there are of it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pipeline/objects/object.hpp"

namespace povslam {

struct RowMember {  // what was seen of it
  std::int64_t object = -1;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // middle of its box, world
  double yaw = 0.0;
  double depth_m = 0.0, width_m = 0.0, height_m = 0.0, bottom_m = 0.0;  // bottom: world
  int end_points = 0;  // of its surface, that face along the row: they show how deep it is
  bool ends_seen = false, bottom_seen = false;
};

struct RowHabits {                       // 0: not known
  double depth_m = 0.0;                  // of what shows its depth best
  double width_m = 0.0, height_m = 0.0;  // median, of those of which nothing hides the ends
  double widest_m = 0.0;                 // nine tenths are no wider
  std::vector<double> bottoms_m;         // of those near, world
};

// A post's piece, by its shape; never if its class is sure.
bool is_post(const MapObject& object);

// None: what it shows has no front, or it is a post.
std::optional<RowMember> row_member(const MapObject& object);

// Of members whose middles lie in the object's own plane, and that stand as it does.
RowHabits row_habits(const MapObject& object, std::span<const RowMember> members);

// Where most of a row's bottoms near this one lie: on the same board. Up to hidden_m below it something hides what is
// there. Nothing if too few agree.
std::optional<double> board_under(std::span<const double> bottoms_m, double bottom_m, double hidden_m);

}  // namespace povslam
