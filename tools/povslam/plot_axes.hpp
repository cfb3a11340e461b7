// A panel with metric grid, tick labels and clipped curves on a canvas.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/povslam/canvas.hpp"

namespace povslam::drawing {

struct Range {
  double low = 0.0, high = 1.0;
  double span() const { return high - low; }
};
// The range that holds all finite values, a little wider; a range of no extent is opened to at least `least`.
Range range_of(std::span<const double> values, double least);

// Round numbers (1, 2 or 5 times a power of ten apart) within the range, about `wanted` of them.
std::vector<double> ticks(const Range& range, int wanted);

class Axes {
 public:
  // The panel's plotting area in pixels; title above it, x label below it.
  Axes(Canvas& canvas, const Eigen::Vector2d& corner_px, const Eigen::Vector2d& size_px, Range x, Range y);

  void widen_to_equal_scale();  // metres of x and y take the same number of pixels
  void draw_frame(const std::string& title, const std::string& x_label) const;
  void vertical_line(double x, const std::string& label) const;
  // Points outside the panel are clipped at its border; a point that is not finite interrupts the curve.
  void curve(std::span<const Eigen::Vector2d> points, const Stroke& stroke) const;
  void dot(const Eigen::Vector2d& point, double radius_px, Color fill) const;

 private:
  Eigen::Vector2d pixel(const Eigen::Vector2d& point) const;
  bool inside(const Eigen::Vector2d& point) const;
  Canvas& canvas_;
  Eigen::Vector2d corner_px_, size_px_;
  Range x_, y_;
  double tick_spacing_x_px_ = 90.0, tick_spacing_y_px_ = 45.0;
};

}  // namespace povslam::drawing
