// The paper's figures of its simulation in the plane: the room after the first frames (5), consistencies and pose error
// over the EM iterations of the first frame (6).
#pragma once

#include <string>
#include <vector>

#include "tools/bench/sim2d_journey.hpp"
#include "tools/povslam/plot_axes.hpp"

namespace povslam::simulated {

inline std::unique_ptr<drawing::Canvas> canvas_for(const std::string& file, int width_px, int height_px) {
  return file.ends_with(".svg") ? drawing::make_svg_canvas(width_px, height_px)
                                : drawing::make_png_canvas(width_px, height_px);
}

inline void draw_outline(const drawing::Axes& axes, const std::array<Eigen::Vector3d, 4>& corners,
                         const drawing::Stroke& stroke) {
  std::array<Eigen::Vector2d, 5> outline;
  for (std::size_t k = 0; k < outline.size(); ++k) outline[k] = corners[k % 4].head<2>();
  axes.curve(outline, stroke);
}

inline void draw_robot(const drawing::Axes& axes, const Rigid3& pose, const drawing::Stroke& stroke) {
  std::vector<Eigen::Vector2d> outline;
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0.5, 0.0, 0.0), Eigen::Vector3d(-0.25, 0.22, 0.0),
                                   Eigen::Vector3d(-0.25, -0.22, 0.0), Eigen::Vector3d(0.5, 0.0, 0.0)}) {
    outline.emplace_back((pose * p).head<2>());
  }
  axes.curve(outline, stroke);
}

inline Status draw_journey(const std::string& file, const Rectangles& scene, const std::vector<JourneyFrame>& frames) {
  constexpr double kPanel_px = 330.0;
  const auto width_px = static_cast<int>(40.0 + (kPanel_px + 60.0) * static_cast<double>(frames.size()));
  const auto canvas = canvas_for(file, width_px, 460);
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const Eigen::Vector2d corner(50.0 + (kPanel_px + 60.0) * static_cast<double>(t), 40.0);
    drawing::Axes axes(*canvas, corner, {kPanel_px, kPanel_px}, {-7.5, 7.5}, {-7.5, 7.5});
    axes.draw_frame("after frame " + std::to_string(t + 1), "m");
    const JourneyFrame& frame = frames[t];
    for (std::size_t i = 0; i < scene.now.size(); ++i) {
      std::array<Eigen::Vector3d, 4> truth = scene.now[i].corners_object(), map{};
      for (Eigen::Vector3d& corner_truth : truth) corner_truth = scene.now[i].T_world_object() * corner_truth;
      for (std::size_t k = 0; k < 4; ++k) map[k] = frame.map.landmarks[4 * i + k].p_prev;
      draw_outline(axes, truth, {{60, 170, 80}, 4.0});
      draw_outline(axes, map,
                   frame.anew[i] != 0 ? drawing::Stroke{{40, 90, 210}, 1.5} : drawing::Stroke{{235, 150, 20}, 1.5});
    }
    draw_robot(axes, scene.T_believed, {{190, 190, 190}, 1.0});
    draw_robot(axes, frame.truth, {{60, 170, 80}, 4.0});
    draw_robot(axes, frame.believed, {{235, 150, 20}, 1.5});
  }
  canvas->text({50, 440},
               "green: as it is   orange: map and pose as estimated   blue: made anew   grey: where the robot took "
               "itself to be at first",
               {{45, 52, 60}, 14.0, drawing::Anchor::left, false});
  return canvas->save(file);
}

inline Status draw_iterations(const std::string& file, const std::vector<char>& moved, const Rigid3& truth,
                              const Rigid3& start, const VemResult& result) {
  const auto canvas = canvas_for(file, 900, 720);
  const auto last = static_cast<double>(result.iterations.size());
  drawing::Axes above(*canvas, {70, 40}, {790, 270}, {0.0, last}, {0.0, 1.0});
  above.draw_frame("E[v] of each object (red: moved) over EM iterations, first frame", "iteration");
  for (std::size_t i = 0; i < moved.size(); ++i) {
    std::vector<Eigen::Vector2d> curve{{0.0, 0.5}};
    for (std::size_t n = 0; n < result.iterations.size(); ++n) {
      curve.emplace_back(static_cast<double>(n + 1), result.consistency[n * moved.size() + i]);
    }
    above.curve(curve, {moved[i] != 0 ? drawing::Color{205, 50, 50} : drawing::Color{40, 130, 70}, 1.8});
  }
  std::vector<Eigen::Vector2d> metres, degrees;
  double most = 0.05;
  for (std::size_t n = 0; n <= result.iterations.size(); ++n) {
    const Vector6d off = local(truth, n == 0 ? start : result.iterations[n - 1].T_world_camera);
    metres.emplace_back(static_cast<double>(n), off.head<3>().norm());
    degrees.emplace_back(static_cast<double>(n), off.tail<3>().norm() * 18.0 / std::numbers::pi);
    most = std::max({most, metres.back().y(), degrees.back().y()});
  }
  drawing::Axes below(*canvas, {70, 390}, {790, 270}, {0.0, last}, {0.0, 1.1 * most});
  below.draw_frame("pose error: position [m] (blue), heading [10 deg] (orange)", "iteration");
  below.curve(metres, {{40, 90, 200}, 2.0});
  below.curve(degrees, {{240, 140, 20}, 2.0});
  return canvas->save(file);
}

}  // namespace povslam::simulated
