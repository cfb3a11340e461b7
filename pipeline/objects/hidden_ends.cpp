#include "pipeline/objects/hidden_ends.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "pipeline/objects/object.hpp"

namespace povslam {
namespace {

constexpr int kSteps = 10;
constexpr int kHeight = 1 << 20;    // as an index: of all heights
constexpr double kBefore_m = 0.06;  // things of one row stand no further before each other
constexpr double kBehind_m = 0.04;
constexpr double kFacing = 0.1;  // cosine
constexpr std::array<double, 3> kAt = {0.25, 0.5, 0.75};

enum class Sight : std::uint8_t { unseen, hidden, at, behind };

struct Frame {  // of the front, volume frame
  Eigen::Vector3d origin, normal, along;
  double half_m, low_m, high_m;

  Eigen::Vector3d point(double u, double z) const {
    return {origin.x() + u * along.x(), origin.y() + u * along.y(), z};
  }
};

Frame frame_of(const SeenBox& seen, const FrontSide& side) {
  const Eigen::AngleAxisd turn(seen.box.yaw, Eigen::Vector3d::UnitZ());
  Frame frame;
  frame.normal =
      turn * (side.plus ? Eigen::Vector3d::Unit(side.across) : Eigen::Vector3d(-Eigen::Vector3d::Unit(side.across)));
  frame.along = turn * Eigen::Vector3d::Unit(side.along());
  frame.origin = seen.box.center + 0.5 * seen.box.size_m[side.across] * frame.normal;
  frame.half_m = 0.5 * seen.box.size_m[side.along()];
  frame.low_m = seen.box.center.z() - 0.5 * seen.box.size_m.z();
  frame.high_m = frame.low_m + seen.box.size_m.z();
  return frame;
}

// What is measured where the point would be seen: before the front's plane, or on it or behind.
Sight look_at(const Eigen::Vector3d& p_camera, const Eigen::Vector3d& normal_camera, const DepthView& view) {
  constexpr int kWide_px = 1, kHigh_px = 3;
  if (p_camera.z() < view.min_depth_m) return Sight::unseen;
  const int x = static_cast<int>(std::lround(view.camera.fx * p_camera.x() / p_camera.z() + view.camera.cx));
  const int y = static_cast<int>(std::lround(view.camera.fy * p_camera.y() / p_camera.z() + view.camera.cy));
  double sum = 0.0;
  int pixels = 0;
  for (int v = std::max(0, y - kHigh_px); v <= std::min(view.camera.height - 1, y + kHigh_px); ++v) {
    for (int u = std::max(0, x - kWide_px); u <= std::min(view.camera.width - 1, x + kWide_px); ++u) {
      if (!(view.depth_m.at(u, v) > 0.0F)) continue;
      sum += static_cast<double>(view.depth_m.at(u, v));
      ++pixels;
    }
  }
  if (pixels < kHigh_px) return Sight::unseen;
  const Eigen::Vector3d ray = p_camera / p_camera.z();
  const double before_m = normal_camera.dot(ray) * (sum / pixels - p_camera.z());
  return before_m > kBefore_m ? Sight::hidden : before_m < -kBehind_m ? Sight::behind : Sight::at;
}

std::array<int, 3> level_spot(const Eigen::Vector3d& p) {
  return {static_cast<int>(std::floor(p.x() / HiddenEnds::kStep_m)),
          static_cast<int>(std::floor(p.y() / HiddenEnds::kStep_m)), kHeight};
}

std::array<int, 3> upright_spot(double z) {
  return {kHeight, kHeight, static_cast<int>(std::floor(z / HiddenEnds::kStep_m))};
}

}  // namespace

std::optional<FrontSide> front_side(const SeenBox& seen) {
  FrontSide front;
  int most = 0;
  for (int side = 0; side < 4; ++side) {
    const int points = seen.sides[static_cast<std::size_t>(side)];
    if (points <= most) continue;
    most = points;
    front = {side / 2, side % 2 == 0};
  }
  return most > 0 ? std::optional(front) : std::nullopt;
}

HiddenEnds::Votes HiddenEnds::of(const Spot& spot) const {
  const auto known = spots_.find(spot);
  return known == spots_.end() ? Votes{} : known->second;
}

void HiddenEnds::look(const SeenBox& seen, const Rigid3& T_world_volume, const DepthView& view) {
  const auto side = front_side(seen);
  if (!side) return;
  ++views_;
  const Frame front = frame_of(seen, *side);
  const Rigid3 T_camera_volume = view.T_world_camera.inverse() * T_world_volume;
  const Eigen::Vector3d toward = (T_camera_volume.inverse().translation - front.origin).normalized();
  if (toward.dot(front.normal) < kFacing) return;
  const Eigen::Vector3d normal_camera = T_camera_volume.rotation * front.normal;
  const auto look = [&](const auto& point_at, std::span<const Spot> spots) {
    std::array<int, 4> seen_at{};
    for (const double share : kAt)
      ++seen_at[static_cast<std::size_t>(look_at(T_camera_volume * point_at(share), normal_camera, view))];
    const auto [unseen, hidden, at, behind] = seen_at;
    if (unseen > 1) return;
    for (const Spot& spot : spots) {
      Votes& votes = spots_[spot];
      if (std::exchange(votes.last_view, views_) == views_) continue;
      std::uint8_t& count = behind > 0 ? votes.behind : at > 0 ? votes.at : votes.hidden;
      if (count < 255) ++count;
    }
  };
  for (int k = 0; k < kSteps; ++k) {
    const double beyond_m = (k + 0.5) * kStep_m;
    for (const double way : {-1.0, 1.0}) {
      const double u = way * (front.half_m + beyond_m);
      // The front is known to some centimetres: spots before and behind it, too.
      std::array<Spot, 3> spots;
      for (std::size_t i = 0; i < 3; ++i)
        spots[i] = level_spot(front.point(u, 0.0) + (static_cast<double>(i) - 1.0) * kStep_m * front.normal);
      look([&](double share) { return front.point(u, front.low_m + share * (front.high_m - front.low_m)); }, spots);
    }
    const double z = front.low_m - beyond_m;
    const Spot below = upright_spot(z);
    look([&](double share) { return front.point((2.0 * share - 1.0) * front.half_m, z); }, {&below, 1});
  }
}

HiddenReach HiddenEnds::reach(const SeenBox& seen) const {
  HiddenReach out;
  const auto side = front_side(seen);
  if (!side || spots_.empty()) return out;
  const Frame front = frame_of(seen, *side);
  // Near its end the object itself may be what is measured: its surface ends early where it is seen slantingly.
  const auto run = [&](const auto& spot_at) {
    constexpr int kViews = 3, kTimes = 4, kNear = 3;
    double reach_m = 0.0;
    for (int k = 0; k < kSteps; ++k) {
      const Votes votes = of(spot_at((k + 0.5) * kStep_m));
      const bool through = kTimes * votes.behind > votes.hidden + votes.at;
      const bool hidden = votes.hidden >= kViews && votes.hidden > votes.at;
      if (through || (!hidden && k >= kNear)) break;
      if (hidden) reach_m = (k + 1) * kStep_m;
    }
    return reach_m;
  };
  const std::size_t along = 2 * static_cast<std::size_t>(side->along());
  if (hardly_seen(seen, static_cast<int>(along) + 1))
    out.minus_m = run([&](double d) { return level_spot(front.point(-front.half_m - d, 0.0)); });
  if (hardly_seen(seen, static_cast<int>(along)))
    out.plus_m = run([&](double d) { return level_spot(front.point(front.half_m + d, 0.0)); });
  out.below_m = run([&](double d) { return upright_spot(front.low_m - d); });
  return out;
}

}  // namespace povslam
