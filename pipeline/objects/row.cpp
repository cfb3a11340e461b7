#include "pipeline/objects/row.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace povslam {
namespace {

constexpr std::size_t kEnough = 5, kNearest = 40;

// Nothing of fewer than enough.
double share_of(std::vector<double>& values, double share) {
  if (values.size() < kEnough) return 0.0;
  const auto at = values.begin() + std::lround(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

// Neighbours hide the far ends of most, and of many only noise shows how deep they are: each counts by how much of its
// end was seen, none for much more than another.
double shown_depth(std::vector<std::pair<double, int>>& depths) {
  constexpr int kLeast = 50, kMostOfOne = 20;
  constexpr double kShare = 0.8;
  int all = 0;
  for (auto& [depth_m, points] : depths) all += points = std::min(points, kMostOfOne);
  if (all < kLeast) return 0.0;
  std::ranges::sort(depths);
  int sum = 0;
  const auto at =
      std::ranges::find_if(depths, [&](const auto& shown) { return (sum += shown.second) >= kShare * all; });
  return std::min(at->first, kDeepest_m);
}

// Nearest first.
std::vector<const RowMember*> members_beside(const MapObject& object, std::span<const RowMember> members) {
  constexpr double kInRow_m = 0.25, kAskew = 0.6;  // sine of twice the angle
  const auto front = front_side(object.seen);
  if (!front) return {};
  const Box box = object.box_world();
  const Eigen::Vector2d normal = Eigen::Rotation2Dd(box.yaw) * Eigen::Vector2d::Unit(front->across);
  std::vector<const RowMember*> beside;
  for (const RowMember& member : members) {
    const bool in_plane = std::abs(normal.dot((member.at - box.center).head<2>())) <= kInRow_m;
    const bool alike = std::abs(std::sin(2.0 * (member.yaw - box.yaw))) <= kAskew;
    if (member.object != object.id && in_plane && alike) beside.push_back(&member);
  }
  std::ranges::sort(beside, {}, [&](const RowMember* member) { return (member->at - box.center).norm(); });
  return beside;
}

}  // namespace

bool is_post(const MapObject& object) {
  constexpr double kThin_m = 0.16, kHigh = 4.0;
  const double width_m = object.seen.box.size_m.head<2>().maxCoeff();
  return !object.class_binds && width_m < kThin_m && object.seen.box.size_m.z() > kHigh * width_m;
}

std::optional<RowMember> row_member(const MapObject& object) {
  const auto front = front_side(object.seen);
  if (!front || is_post(object)) return std::nullopt;
  const Eigen::Vector3d& size = object.seen.box.size_m;
  const auto end = 2 * static_cast<std::size_t>(front->along());
  const HiddenReach hidden = object.hidden.reach(object.seen);
  const Box box = object.box_world();
  RowMember member{object.id, box.center, box.yaw};
  member.depth_m = size[front->across];
  member.width_m = size[front->along()];
  member.height_m = size.z();
  member.bottom_m = object.T_world_volume.translation.z() + object.seen.box.center.z() - 0.5 * size.z();
  member.end_points = std::max(object.seen.sides[end], object.seen.sides[end + 1]);
  member.ends_seen = hidden.minus_m + hidden.plus_m <= 0.0;
  member.bottom_seen = hidden.below_m <= 0.0;
  return member;
}

RowHabits row_habits(const MapObject& object, std::span<const RowMember> members) {
  constexpr double kMost = 0.9;
  RowHabits habits;
  std::vector<std::pair<double, int>> depths;
  std::vector<double> all_widths, widths, heights;
  for (const RowMember* member : members_beside(object, members)) {
    depths.emplace_back(member->depth_m, member->end_points);
    if (all_widths.size() >= kNearest) continue;
    all_widths.push_back(member->width_m);
    if (member->ends_seen) widths.push_back(member->width_m);
    if (!member->bottom_seen) continue;
    heights.push_back(member->height_m);
    habits.bottoms_m.push_back(member->bottom_m);
  }
  habits.depth_m = shown_depth(depths);
  habits.width_m = share_of(widths, 0.5);
  habits.height_m = share_of(heights, 0.5);
  habits.widest_m = share_of(all_widths, kMost);
  return habits;
}

// A view takes some centimetres of a thing for the board below it, or all of the board for the thing: the lower ones of
// those that agree are right.
std::optional<double> board_under(std::span<const double> bottoms_m, double bottom_m, double hidden_m) {
  constexpr double kAgree_m = 0.025, kAlike_m = 0.04, kLower_m = 0.08, kHigher_m = 0.15, kStep_m = 0.05;
  constexpr std::size_t kAgree = 4, kLowest = 6;  // of six
  const double lower_m = std::max(kLower_m, hidden_m + kStep_m);
  std::size_t most = kAgree - 1;
  std::optional<double> board;
  for (const double level : bottoms_m) {
    if (level < bottom_m - lower_m || level > bottom_m + kHigher_m) continue;
    std::vector<double> alike;
    std::size_t agree = 0;
    for (const double other : bottoms_m) {
      agree += std::abs(other - level) <= kAgree_m ? 1 : 0;
      if (std::abs(other - level) <= kAlike_m) alike.push_back(other);
    }
    if (agree <= most) continue;
    most = agree;
    const auto low = alike.begin() + std::ssize(alike) / static_cast<std::ptrdiff_t>(kLowest);
    std::ranges::nth_element(alike, low);
    board = *low;
  }
  return board;
}

}  // namespace povslam
