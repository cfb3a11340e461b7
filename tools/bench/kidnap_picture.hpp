// The tries from above: where each was, where it looked, what became of it.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tools/bench/kidnap_score.hpp"
#include "tools/povslam/plot_axes.hpp"

namespace povslam {

inline drawing::Color color_of(const Try& tried) {
  if (tried.any_wrong()) return {220, 30, 40};
  if (tried.found()) return {40, 150, 70};
  return tried.known == Known::mapped ? drawing::Color{240, 150, 20} : drawing::Color{150, 155, 165};
}

inline Status draw_tries(const std::string& file, const std::string& title, const synthetic::Scene& scene,
                         double time_s, const std::vector<Try>& tries) {
  constexpr int kWidth_px = 1400, kHeight_px = 1000;
  const auto canvas = drawing::make_png_canvas(kWidth_px, kHeight_px);
  Eigen::AlignedBox2d extent;
  for (const auto& floor : scene.floors) extent.extend(floor);
  const drawing::Range x{extent.min().x() - 0.5, extent.max().x() + 0.5};
  const drawing::Range y{extent.min().y() - 0.5, extent.max().y() + 0.5};
  drawing::Axes axes(*canvas, {60, 50}, {kWidth_px - 90.0, kHeight_px - 150.0}, x, y);
  axes.widen_to_equal_scale();
  axes.draw_frame(title, "m");
  for (const synthetic::Object& object : scene.objects) {
    const synthetic::Placement there = object.at(time_s);
    if (!there.present || object.class_id == synthetic::ClassId::goods) continue;
    const synthetic::Footprint ground = footprint(object, there);
    std::array<Eigen::Vector2d, 5> outline;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Eigen::Vector2d corner(i % 4 == 1 || i % 4 == 2 ? 1.0 : -1.0, i % 4 >= 2 ? 1.0 : -1.0);
      outline[i] = ground.center + Eigen::Rotation2Dd(ground.yaw) * corner.cwiseProduct(ground.half_m);
    }
    axes.curve(outline, {{170, 175, 182}, 1.5});
  }
  const std::vector<Eigen::Vector2d> path = synthetic::sample_path(scene.path);
  axes.curve(path, {{120, 170, 230}, 2.0});
  for (const Try& tried : tries) {
    const Eigen::Vector2d at(tried.drift.x, tried.drift.y);
    const Eigen::Vector2d ahead = at + 0.35 * Eigen::Vector2d(std::cos(tried.drift.yaw), std::sin(tried.drift.yaw));
    axes.curve(std::array{at, ahead}, {color_of(tried), 1.5});
    axes.dot(at, tried.any_wrong() ? 6.0 : 3.5, color_of(tried));
    const Eigen::Vector2d claimed = tried.T_world_body_worst.translation.head<2>();
    if (tried.any_wrong()) axes.curve(std::array{at, claimed}, {color_of(tried), 1.0});
  }
  canvas->text(
      {60, kHeight_px - 30.0},
      "green: found   orange: not found though mapped   grey: not found, need not be   red: wrong, with a line "
      "to the pose claimed   blue: the drive that made the map",
      {{45, 52, 60}, 15.0, drawing::Anchor::left, false});
  return canvas->save(file);
}

}  // namespace povslam
