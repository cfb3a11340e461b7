// Where a kidnapped robot may find itself in a simulated world, how it moves from there, and whether its view could as
// well be had from elsewhere. All by truth.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/synthetic/ground.hpp"
#include "drivers/synthetic/random.hpp"
#include "drivers/synthetic/renderer.hpp"

namespace povslam {

enum class Place { lap, anywhere, other_room, bay };
inline constexpr const char* kPlaceNames[] = {"lap", "anywhere", "other_room", "bay"};

// A level camera at robot height that rolls and turns slowly.
struct Drift {
  double x = 0.0, y = 0.0, yaw = 0.0;  // body at the beginning
  double speed_mps = 0.0, turn_radps = 0.0;

  Rigid3 T_world_body(double time_s) const {
    const double turned = turn_radps * time_s;  // on an arc: straight along the middle heading
    const double middle = yaw + 0.5 * turned, way = speed_mps * time_s;
    return {so3_exp({0.0, 0.0, yaw + turned}), {x + way * std::cos(middle), y + way * std::sin(middle), 0.0}};
  }
  Rigid3 T_world_camera(double time_s) const { return T_world_body(time_s) * synthetic::RobotMotion::T_body_camera(); }
};

class KidnapTries {
 public:
  KidnapTries(const synthetic::World& world, double time_s, std::uint64_t seed)
      : world_(world), time_s_(time_s), random_(synthetic::mix(seed, 606)) {}

  // Nothing: the world has no such place.
  std::optional<Drift> draw(Place place, double seconds) {
    for (int attempt = 0; attempt < 1000; ++attempt) {
      std::optional<Drift> drift = pose_in(place);
      if (!drift) return std::nullopt;
      drift->speed_mps = random_.uniform(0.0, 0.3);
      drift->turn_radps = random_.uniform(-kTurn_radps, kTurn_radps);
      const Eigen::Vector3d end = drift->T_world_body(seconds).translation;
      if (is_free(drift->x, drift->y) && is_free(end.x(), end.y())) return drift;
    }
    return std::nullopt;
  }

  // On the lap, along its heading, standing.
  Drift on_lap() {
    const auto pose = world_.scene().path.at(random_.uniform(0.0, world_.scene().path.length_m()));
    return {pose.x, pose.y, pose.yaw, 0.0, 0.0};
  }

  bool is_free(double x, double y) const {
    const Eigen::Vector2d at(x, y);
    const auto& floors = world_.scene().floors;
    if (std::none_of(floors.begin(), floors.end(), [&](const auto& floor) { return floor.contains(at); })) return false;
    return std::all_of(world_.scene().objects.begin(), world_.scene().objects.end(), [&](const auto& object) {
      const synthetic::Placement there = object.at(time_s_);
      return !there.present || distance_m(footprint(object, there), at) >= kRadius_m;
    });
  }

 private:
  static constexpr double kRadius_m = 0.35, kTurn_radps = 20.0 * synthetic::kPi / 180.0;

  std::optional<Drift> pose_in(Place place) {
    const synthetic::Scene& scene = world_.scene();
    const double half_turn = synthetic::kPi;
    if (place == Place::lap) {
      const auto pose = scene.path.at(random_.uniform(0.0, scene.path.length_m()));
      const double aside = random_.uniform(-1.0, 1.0), turn = random_.uniform(-half_turn, half_turn) / 3.0;
      return Drift{pose.x - aside * std::sin(pose.yaw), pose.y + aside * std::cos(pose.yaw), pose.yaw + turn, 0.0, 0.0};
    }
    if (place == Place::bay) {
      if (scene.twin_pitch_m == 0.0) return std::nullopt;
      const double turn = random_.uniform(-half_turn, half_turn) * 50.0 / 180.0;
      return Drift{random_.uniform(-2.0, 2.0) * scene.twin_pitch_m, random_.uniform(-3.6, -1.4),
                   -0.5 * half_turn + turn, 0.0, 0.0};
    }
    const std::size_t room = place == Place::other_room ? 1 : 0;
    if (room >= scene.floors.size()) return std::nullopt;
    const Eigen::Vector2d low = scene.floors[room].min(), high = scene.floors[room].max();
    return Drift{random_.uniform(low.x(), high.x()), random_.uniform(low.y(), high.y()),
                 random_.uniform(-half_turn, half_turn), 0.0, 0.0};
  }

  const synthetic::World& world_;
  double time_s_;
  synthetic::Random random_;
};

// Compares perfect pictures, a quarter of the camera's size, from a place and from where its twins would be.
class TwinCheck {
 public:
  static Result<TwinCheck> create(synthetic::SyntheticOptions options) {
    PinholeCamera& camera = options.camera;
    camera = {camera.width / 4,
              camera.height / 4,
              camera.fx / 4,
              camera.fy / 4,
              (camera.cx - 1.5) / 4,
              (camera.cy - 1.5) / 4,
              {}};
    options.noise = 0.0;
    Result<synthetic::World> world = synthetic::World::create(options);
    if (!world) return world.error();
    return TwinCheck(std::move(*world));
  }

  // Least share of pixels that differ between the view and one from another place that a robot could stand at; 1 where
  // there is none.
  double least_difference(const Rigid3& T_world_camera, double time_s, const KidnapTries& tries) {
    const double pitch_m = world_->scene().twin_pitch_m;
    if (pitch_m == 0.0) return 1.0;
    renderer_->render(T_world_camera, time_s, here_);
    double least = 1.0;
    for (int k = -4; k <= 4; ++k) {
      Rigid3 there = T_world_camera;
      there.translation.x() += k * pitch_m;
      if (k == 0 || !tries.is_free(there.translation.x(), there.translation.y())) continue;
      renderer_->render(there, time_s, there_);
      least = std::min(least, difference());
    }
    return least;
  }

 private:
  explicit TwinCheck(synthetic::World world)
      : world_(std::make_unique<synthetic::World>(std::move(world))),
        renderer_(std::make_unique<synthetic::Renderer>(*world_)) {}

  double difference() const {
    constexpr int kGrey = 2, kDepth_mm = 5;
    std::size_t differing = 0;
    for (std::size_t p = 0; p < here_.depth.size(); ++p) {
      bool same = std::abs(here_.depth.data()[p] - there_.depth.data()[p]) <= kDepth_mm;
      for (std::size_t c = 0; c < 3; ++c)
        same = same && std::abs(here_.color.data()[3 * p + c] - there_.color.data()[3 * p + c]) <= kGrey;
      differing += !same;
    }
    return static_cast<double>(differing) / static_cast<double>(here_.depth.size());
  }

  std::unique_ptr<synthetic::World> world_;  // the renderer refers to it
  std::unique_ptr<synthetic::Renderer> renderer_;
  RgbdFrame here_, there_;
};

}  // namespace povslam
