// The paper's simulation in the plane: rectangles in a room, of which a robot measures all four corners in each frame;
// some stand elsewhere than its map says. Set-up where the paper is silent: 12 x 12 m, sides 0.6-1.4 m, gaps > 0.3 m,
// shifts 0.8-2 m and up to 30 degrees, corners measured to 2 cm.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "pipeline/backend/window.hpp"

namespace povslam::simulated {

struct RectanglesOptions {
  int num_objects = 10, num_moved = 6;
  double room_m = 12.0;
  double noise_m = 0.02;                   // of a measured corner, per axis
  double start_m = 0.3, start_rad = 0.14;  // the robot is spawned up to so far from where it believes to be
  double shift_min_m = 0.8, shift_max_m = 2.0, turn_max_rad = 0.5236;
  bool common_shift = false;  // all moved ones by the same vector, none turned
  unsigned seed = 1;
};

struct Rectangle {
  Eigen::Vector2d position = Eigen::Vector2d::Zero(), half = Eigen::Vector2d::Ones();
  double yaw = 0.0;

  std::array<Eigen::Vector3d, 4> corners_object() const {
    return {Eigen::Vector3d(half.x(), half.y(), 0.0), Eigen::Vector3d(-half.x(), half.y(), 0.0),
            Eigen::Vector3d(-half.x(), -half.y(), 0.0), Eigen::Vector3d(half.x(), -half.y(), 0.0)};
  }
  Rigid3 T_world_object() const { return {so3_exp({0.0, 0.0, yaw}), {position.x(), position.y(), 0.0}}; }
};

// Within `gap_m` of each other, by the corners and edges of both (separating axes).
inline bool too_near(const Rectangle& a, const Rectangle& b, double gap_m) {
  const Eigen::Vector2d between = b.position - a.position;
  for (const double yaw : {a.yaw, a.yaw + 0.5 * std::numbers::pi, b.yaw, b.yaw + 0.5 * std::numbers::pi}) {
    const Eigen::Vector2d axis(std::cos(yaw), std::sin(yaw));
    const auto reach = [&axis](const Rectangle& r) {
      const Eigen::Vector2d x(std::cos(r.yaw), std::sin(r.yaw)), y(-x.y(), x.x());
      return r.half.x() * std::abs(x.dot(axis)) + r.half.y() * std::abs(y.dot(axis));
    };
    if (std::abs(between.dot(axis)) > reach(a) + reach(b) + gap_m) return false;
  }
  return true;
}

struct Rectangles {
  std::vector<Rectangle> map, now;  // as the robot's map has them, as they are
  std::vector<char> moved;
  Rigid3 T_world_robot, T_believed;  // of the first frame
};

class RectanglesMaker {
 public:
  explicit RectanglesMaker(const RectanglesOptions& options) : options_(options), random_(options.seed) {}

  Rectangles make() {
    std::optional<Rectangles> scene;
    while (!scene) scene = try_scene();  // a crowded room may leave no place: begin anew
    return *scene;
  }

 private:
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

  std::optional<Rectangles> try_scene() {
    Rectangles scene;
    spawn(scene);
    for (int i = 0; i < options_.num_objects; ++i) {
      const auto placed = place(scene, scene.map, [this] {
        return Rectangle{{wall(), wall()}, {uniform(0.3, 0.7), uniform(0.3, 0.7)}, uniform(-1.5, 1.5)};
      });
      if (!placed) return std::nullopt;
      scene.map.push_back(*placed);
      scene.moved.push_back(i < options_.num_moved ? 1 : 0);
    }
    const double common_way = uniform(-std::numbers::pi, std::numbers::pi);
    const double common_length = uniform(options_.shift_min_m, options_.shift_max_m);
    for (std::size_t i = scene.map.size(); i-- > 0;) {  // those that stay come last
      const auto placed = place(scene, scene.now, [&, this] {
        return scene.moved[i] != 0 ? shifted(scene.map[i], common_way, common_length) : scene.map[i];
      });
      if (!placed) return std::nullopt;
      scene.now.push_back(*placed);
    }
    std::ranges::reverse(scene.now);
    return scene;
  }

  double wall() { return uniform(-0.5 * options_.room_m + 1.0, 0.5 * options_.room_m - 1.0); }

  Rectangle shifted(const Rectangle& from, double common_way, double common_length) {
    const bool common = options_.common_shift;
    const double way = common ? common_way : uniform(-std::numbers::pi, std::numbers::pi);
    const double length = common ? common_length : uniform(options_.shift_min_m, options_.shift_max_m);
    const double turn = common ? 0.0 : uniform(-options_.turn_max_rad, options_.turn_max_rad);
    return {from.position + length * Eigen::Vector2d(std::cos(way), std::sin(way)), from.half, from.yaw + turn};
  }

  template <class Draw>
  std::optional<Rectangle> place(const Rectangles& scene, const std::vector<Rectangle>& others, Draw draw) {
    constexpr double kGap_m = 0.3, kRobot_m = 1.5;  // room for it to drive
    for (int i = 0; i < 100; ++i) {
      const Rectangle candidate = draw();
      const auto near = [&candidate](const Rectangle& other) { return too_near(candidate, other, kGap_m); };
      const Eigen::Vector2d from_robot = candidate.position - scene.T_world_robot.translation.head<2>();
      if (from_robot.norm() < candidate.half.norm() + kRobot_m) continue;
      if (std::ranges::none_of(others, near)) return candidate;
    }
    return std::nullopt;
  }

  void spawn(Rectangles& scene) {
    scene.T_world_robot = {so3_exp({0.0, 0.0, uniform(-3.0, 3.0)}), {uniform(-2.0, 2.0), uniform(-2.0, 2.0), 0.0}};
    const double way = uniform(-std::numbers::pi, std::numbers::pi), length = uniform(0.0, options_.start_m);
    Vector6d off = Vector6d::Zero();
    off << length * std::cos(way), length * std::sin(way), 0.0, 0.0, 0.0,
        uniform(-options_.start_rad, options_.start_rad);
    scene.T_believed = retract(scene.T_world_robot, off);
  }

  RectanglesOptions options_;
  std::mt19937 random_;
};

// The objects of a window as a map has them, without frames.
inline VemWindow rectangles_map(const std::vector<Rectangle>& map) {
  VemWindow window;
  window.dimension = 2;
  for (const Rectangle& rectangle : map) {
    VemObject object;
    object.position = rectangle.T_world_object().translation;
    object.yaw = rectangle.yaw;
    object.belief = {0.0, 0.01, 1.0, 1.0};  // E[v] = 0.5, as in the paper
    object.num_landmarks = 4;
    window.objects.push_back(object);
    for (const Eigen::Vector3d& corner : rectangle.corners_object()) {
      const Eigen::Vector3d p_world = rectangle.T_world_object() * corner;
      window.landmarks.push_back({p_world, corner, p_world});
    }
  }
  return window;
}

// All corners of all rectangles as they are, seen from the pose.
inline std::vector<Eigen::Vector3d> see_corners(const std::vector<Rectangle>& now, const Rigid3& T_world_robot,
                                                double noise_m, std::mt19937& random) {
  std::normal_distribution<double> noise(0.0, noise_m);
  std::vector<Eigen::Vector3d> seen;
  for (const Rectangle& rectangle : now) {
    for (const Eigen::Vector3d& corner : rectangle.corners_object()) {
      const double x = noise(random), y = noise(random);
      seen.push_back(T_world_robot.inverse() * (rectangle.T_world_object() * corner) + Eigen::Vector3d(x, y, 0.0));
      seen.back().z() = 0.0;
    }
  }
  return seen;
}

// The first frame as the paper's figure 6 has it: a window of one.
inline VemWindow first_frame(const Rectangles& scene, const RectanglesOptions& options) {
  std::mt19937 random(options.seed + 1'000'000U);
  VemWindow window = rectangles_map(scene.map);
  window.poses = {scene.T_believed};
  window.prior = {scene.T_believed, 0.5, 0.2};
  const auto seen = see_corners(scene.now, scene.T_world_robot, options.noise_m, random);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    window.matches.push_back({0, static_cast<std::int32_t>(i), seen[i], 0.1});
  }
  return window;
}

}  // namespace povslam::simulated
