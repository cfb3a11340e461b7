// What a drive saw, by truth: which surfaces, from where. Says of a view how much of it the drive knows.
#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "drivers/synthetic/raster.hpp"
#include "drivers/synthetic/world.hpp"

namespace povslam {

class SeenSurfaces {
 public:
  explicit SeenSurfaces(const synthetic::World& world) : world_(world), camera_(coarse(world.options().camera)) {}

  void add(const Rigid3& T_world_camera, double time_s) {
    each_point(T_world_camera, time_s, [this](const Point& point) {
      std::vector<Look>& looks = looks_[point.cell];
      for (const Look& look : looks) {
        if (alike(look, point.look, kNewCosine, kNewRatio)) return;
      }
      looks.push_back(point.look);
    });
  }

  // Shares of the image. Only surfaces of things count, within kReach_m: not the floor, which has no features.
  struct Share {
    double surfaces = 0.0;  // things at all
    double seen = 0.0;      // seen by the drive, from wherever
    double alike = 0.0;     // from within 30 degrees and a factor of 1.6 in distance
  };
  Share of(const Rigid3& T_world_camera, double time_s) {
    int surfaces = 0, seen = 0, similar = 0;
    each_point(T_world_camera, time_s, [&](const Point& point) {
      ++surfaces;
      const auto found = looks_.find(point.cell);
      if (found == looks_.end()) return;
      ++seen;
      for (const Look& look : found->second) {
        if (!alike(look, point.look, kAlikeCosine, kAlikeRatio)) continue;
        ++similar;
        return;
      }
    });
    const double pixels = static_cast<double>(camera_.width) * camera_.height;
    return {surfaces / pixels, seen / pixels, similar / pixels};
  }

 private:
  static constexpr double kReach_m = 7.0, kCell_m = 0.15;
  static constexpr double kNewCosine = 0.97, kNewRatio = 1.3;  // looks worth keeping apart
  static constexpr double kAlikeCosine = 0.8660254, kAlikeRatio = 1.6;

  struct Look {
    Eigen::Vector3f toward_camera;  // unit
    float distance_m;
  };
  struct Point {
    std::uint64_t cell;
    Look look;
  };

  static PinholeCamera coarse(const PinholeCamera& camera) {
    constexpr int kEvery = 8;  // px
    PinholeCamera small = camera;
    small.width = camera.width / kEvery;
    small.height = camera.height / kEvery;
    small.fx /= kEvery;
    small.fy /= kEvery;
    small.cx = (camera.cx + 0.5) / kEvery - 0.5;
    small.cy = (camera.cy + 0.5) / kEvery - 0.5;
    return small;
  }

  static bool alike(const Look& a, const Look& b, double cosine, double ratio) {
    const double further = std::max(a.distance_m, b.distance_m), nearer = std::min(a.distance_m, b.distance_m);
    return static_cast<double>(a.toward_camera.dot(b.toward_camera)) >= cosine && further <= ratio * nearer;
  }

  static std::uint64_t cell_of(const Eigen::Vector3d& p_world) {
    std::uint64_t key = 0;
    for (const double x : {p_world.x(), p_world.y(), p_world.z()})
      key = key << 21 | (static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(x / kCell_m))) & 0x1FFFFF);
    return key;
  }

  template <class Take>
  void each_point(const Rigid3& T_world_camera, double time_s, const Take& take) {
    const synthetic::View view(camera_, T_world_camera);
    synthetic::find_faces(world_.scene(), time_s, view, faces_);
    raster_.cast(view, faces_);
    for (int y = 0; y < camera_.height; ++y) {
      for (int x = 0; x < camera_.width; ++x) {
        const auto w = static_cast<double>(raster_.inverse_depth().at(x, y));
        if (raster_.hit().at(x, y) < synthetic::Raster::kFirstFace || w * kReach_m < 1.0) continue;
        const Eigen::Vector3d p_world = T_world_camera * (camera_.unproject({x, y}) / w);
        const Eigen::Vector3d toward = T_world_camera.translation - p_world;
        take({cell_of(p_world), {toward.normalized().cast<float>(), static_cast<float>(toward.norm())}});
      }
    }
  }

  const synthetic::World& world_;
  PinholeCamera camera_;
  std::vector<synthetic::ProjectedFace> faces_;
  synthetic::Raster raster_;
  std::unordered_map<std::uint64_t, std::vector<Look>> looks_;
};

}  // namespace povslam
