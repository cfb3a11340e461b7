// A sheet to draw on: lines, dots and text, in pixels from the top left corner (x right, y down).
// Two back ends draw the same content: pixels (PNG, OpenCV) and shapes (SVG text).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "pipeline/base/result.hpp"

namespace povslam::drawing {

struct Color {
  std::uint8_t red = 0, green = 0, blue = 0;
};

struct Stroke {
  Color color;
  double width_px = 1.0;
};

enum class Anchor : std::uint8_t { left, middle, right };

struct TextStyle {
  Color color;
  double size_px = 14.0;  // height of a line of text
  Anchor anchor = Anchor::left;
  bool bold = false;
};

class Canvas {
 public:
  virtual ~Canvas() = default;
  virtual void polyline(std::span<const Eigen::Vector2d> points_px, const Stroke& stroke) = 0;
  virtual void rectangle(const Eigen::Vector2d& corner_px, const Eigen::Vector2d& size_px, Color fill) = 0;
  virtual void dot(const Eigen::Vector2d& centre_px, double radius_px, Color fill) = 0;
  virtual void text(const Eigen::Vector2d& baseline_px, const std::string& text, const TextStyle& style) = 0;  // ASCII
  virtual Status save(const std::string& file) const = 0;
};

// White sheets.
std::unique_ptr<Canvas> make_png_canvas(int width_px, int height_px);
std::unique_ptr<Canvas> make_svg_canvas(int width_px, int height_px);

}  // namespace povslam::drawing
