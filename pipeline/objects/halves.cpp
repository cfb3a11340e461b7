#include "pipeline/objects/halves.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace povslam {
namespace {

constexpr double kLevel_m = 0.075, kOnePlane_m = 0.10, kOverlap_m = 0.05, kApart_m = 0.4, kWider_m = 0.08;
constexpr double kFaces = 0.8, kSameWay = 0.6;  // cosines

// The upright side of an object that most of its surface shows.
struct Front {
  Eigen::Vector3d center = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();  // world; horizontal, unit
};

Front front_of(const MapObject& object) {
  Front front;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const SurfacePoint& point : object.surface) {
    if (std::abs(point.normal.z()) < 0.5F) sum += point.normal.cast<double>();
  }
  sum.z() = 0.0;
  if (sum.norm() < 1e-6) return front;
  const Eigen::Vector3d normal = sum.normalized();
  int points = 0;
  for (const SurfacePoint& point : object.surface) {
    if (point.normal.cast<double>().dot(normal) < kFaces) continue;
    front.center += point.p_volume.cast<double>();
    ++points;
  }
  if (points == 0) return front;
  front.center = object.T_world_volume * (front.center / points);
  front.normal = object.T_world_volume.rotation * normal;
  return front;
}

struct Extent {
  double low = 1e9, high = -1e9;
  void add(double v) { low = std::min(low, v), high = std::max(high, v); }
};

// Of its surface along a direction and upwards, world.
std::pair<Extent, Extent> extents(const MapObject& object, const Eigen::Vector3d& along) {
  std::pair<Extent, Extent> out;
  for (const SurfacePoint& point : object.surface) {
    const Eigen::Vector3d p = object.T_world_volume * point.p_volume.cast<double>();
    out.first.add(along.dot(p));
    out.second.add(p.z());
  }
  return out;
}

// Both as seen along their common front.
struct Pair {
  Eigen::Vector3d normal, along;
  double plane_m = 0.0;  // along the normal
  Extent along_a, along_b, up_a, up_b;
  bool one_plane = false;
};

Pair side_by_side(const MapObject& a, const MapObject& b) {
  const Front front_a = front_of(a), front_b = front_of(b);
  Pair pair;
  const Front& wider = a.surface.size() >= b.surface.size() ? front_a : front_b;
  pair.normal = wider.normal;
  pair.along = Eigen::Vector3d::UnitZ().cross(pair.normal);
  pair.one_plane = front_a.normal.dot(front_b.normal) > kSameWay &&
                   std::abs(pair.normal.dot(front_a.center - front_b.center)) < kOnePlane_m;
  pair.plane_m = pair.normal.dot(wider.center);
  std::tie(pair.along_a, pair.up_a) = extents(a, pair.along);
  std::tie(pair.along_b, pair.up_b) = extents(b, pair.along);
  return pair;
}

}  // namespace

bool may_be_halves(const MapObject& a, const MapObject& b, double widest_m) {
  const Pair pair = side_by_side(a, b);
  if (!pair.one_plane) return false;
  const bool level =
      std::abs(pair.up_a.low - pair.up_b.low) < kLevel_m && std::abs(pair.up_a.high - pair.up_b.high) < kLevel_m;
  const double width_m = std::max(pair.along_a.high, pair.along_b.high) - std::min(pair.along_a.low, pair.along_b.low);
  const double apart_m = std::max(pair.along_a.low, pair.along_b.low) - std::min(pair.along_a.high, pair.along_b.high);
  return level && width_m <= widest_m + kWider_m && apart_m < kApart_m && apart_m > -kOverlap_m;
}

Between look_between(const MapObject& a, const MapObject& b, const DepthView& view) {
  constexpr std::array<double, 3> kHeights = {0.25, 0.5, 0.75};
  constexpr int kReach_px = 3;
  constexpr double kNearer_m = 0.03, kBeyond_m = 0.10;
  const Pair pair = side_by_side(a, b);
  const double middle =
      0.5 * (std::max(pair.along_a.low, pair.along_b.low) + std::min(pair.along_a.high, pair.along_b.high));
  int nearer = 0, beyond = 0;
  for (const double height : kHeights) {
    const Eigen::Vector3d p_world =
        middle * pair.along + pair.plane_m * pair.normal +
        (pair.up_a.low + height * (pair.up_a.high - pair.up_a.low)) * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d p = view.T_world_camera.inverse() * p_world;
    if (p.z() < view.min_depth_m) continue;
    const int x = static_cast<int>(std::lround(view.camera.fx * p.x() / p.z() + view.camera.cx));
    const int y = static_cast<int>(std::lround(view.camera.fy * p.y() / p.z() + view.camera.cy));
    double sum = 0.0;
    int pixels = 0;
    for (int v = std::max(0, y - kReach_px); v <= std::min(view.camera.height - 1, y + kReach_px); ++v) {
      for (int u = std::max(0, x - kReach_px); u <= std::min(view.camera.width - 1, x + kReach_px); ++u) {
        if (!(view.depth_m.at(u, v) > 0.0F)) continue;
        sum += static_cast<double>(view.depth_m.at(u, v));
        ++pixels;
      }
    }
    if (pixels < kReach_px * kReach_px) continue;
    nearer += sum / pixels < p.z() - kNearer_m ? 1 : 0;
    beyond += sum / pixels > p.z() + kBeyond_m ? 1 : 0;
  }
  if (beyond > 0) return Between::open;
  return nearer >= 2 ? Between::hidden : Between::unseen;
}

}  // namespace povslam
