#include "pipeline/objects/neighbours.hpp"

#include <algorithm>
#include <cmath>

namespace povslam {

std::optional<Eigen::AlignedBox3d> beside(const MapObject& object, const MapObject& other) {
  constexpr double kAskew = 0.5;  // sine of twice the angle
  const Rigid3 T_object_other = object.T_world_volume.inverse() * other.T_world_volume;
  const Box box = MapObject::moved(other.seen.box, T_object_other);
  const double turn = box.yaw - object.seen.box.yaw;
  if (std::abs(std::sin(2.0 * turn)) > kAskew) return std::nullopt;
  const double c = std::abs(std::cos(turn)), s = std::abs(std::sin(turn));
  const Eigen::Vector3d half = 0.5 * Eigen::Vector3d(c * box.size_m.x() + s * box.size_m.y(),
                                                     s * box.size_m.x() + c * box.size_m.y(), box.size_m.z());
  const Eigen::Vector3d center =
      Eigen::AngleAxisd(-object.seen.box.yaw, Eigen::Vector3d::UnitZ()) * (box.center - object.seen.box.center);
  return Eigen::AlignedBox3d(center - half, center + half);
}

std::optional<Neighbour> neighbour(const MapObject& object, const MapObject& other, int along) {
  constexpr double kShared = 0.3;
  const auto box = beside(object, other);
  if (!box) return std::nullopt;
  const Eigen::AlignedBox3d own(-0.5 * object.seen.box.size_m, 0.5 * object.seen.box.size_m);
  for (const int axis : {1 - along, 2}) {
    const double both_m = std::min(own.max()[axis], box->max()[axis]) - std::max(own.min()[axis], box->min()[axis]);
    if (both_m < kShared * std::min(own.sizes()[axis], box->sizes()[axis])) return std::nullopt;
  }
  const bool plus = box->center()[along] > 0.0;
  return Neighbour{plus, plus ? box->min()[along] - own.max()[along] : own.min()[along] - box->max()[along]};
}

bool hidden_between(const MapObject& object, const MapObject& other) {
  const auto front = front_side(object.seen);
  if (!front) return false;
  const auto beyond = neighbour(object, other, front->along());
  if (!beyond) return false;
  const HiddenReach reach = object.hidden.reach(object.seen);
  return (beyond->plus ? reach.plus_m : reach.minus_m) >= beyond->gap_m - HiddenEnds::kStep_m && beyond->gap_m > 0.0;
}

}  // namespace povslam
