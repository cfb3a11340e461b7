#include "tools/povslam/scores/side_sightings.hpp"

#include <algorithm>

namespace povslam::scores {
namespace {

constexpr int kFrames = 3;
constexpr double kFarthest_m = 6.0;
constexpr double kFlattest = 0.26;  // sine of 15 degrees

}  // namespace

SideSightings::SideSightings(const OrientedBox& box) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(box.yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  for (std::size_t side = 0; side < sides_.size(); ++side) {
    const auto across = static_cast<Eigen::Index>(side / 2);
    const double way = side % 2 == 0 ? 1.0 : -1.0;
    sides_[side].normal_world = way * R.col(across);
    for (std::size_t i = 0; i < kGrid * kGrid; ++i) {
      Eigen::Vector3d share;
      share[across] = 0.5 * way;
      share[1 - across] = (static_cast<double>(i % kGrid) + 0.5) / kGrid - 0.5;
      share.z() = (static_cast<double>(i / kGrid) + 0.5) / kGrid - 0.5;
      sides_[side].points_world[i] = box.center_world + R * share.cwiseProduct(box.size_m);
    }
  }
}

void SideSightings::look(const TrueView& view) {
  const Eigen::Vector3d camera_world = view.T_camera_world.inverse().translation;
  for (Side& side : sides_) {
    for (std::size_t i = 0; i < side.frames.size(); ++i) {
      const Eigen::Vector3d to_camera = camera_world - side.points_world[i];
      const double distance_m = to_camera.norm();
      if (distance_m > kFarthest_m || to_camera.dot(side.normal_world) < kFlattest * distance_m) continue;
      if (sees_point(view, side.points_world[i], &side.normal_world)) ++side.frames[i];
    }
  }
}

bool SideSightings::seen(std::size_t side) const {
  const auto& frames = sides_[side].frames;
  return 2 * static_cast<std::size_t>(std::ranges::count_if(frames, [](int n) { return n >= kFrames; })) >=
         frames.size();
}

}  // namespace povslam::scores
