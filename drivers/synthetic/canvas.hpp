// A surface to print on, in metres of the real face: x to the right, y down.
#pragma once

#include <vector>

#include "drivers/synthetic/random.hpp"
#include "drivers/synthetic/texture.hpp"

namespace povslam::synthetic {

struct Ink {
  int red = 0, green = 0, blue = 0;
  Ink lighter(int by) const { return {red + by, green + by, blue + by}; }
};

struct Area {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;  // metres
};

class Canvas {
 public:
  Canvas(double width_m, double height_m, double texels_per_m);

  void base(Ink ink, double cloudiness, Random& random);  // plain with soft clouds of so many grey levels
  void rectangle(const Area& area, Ink ink);
  void frame(const Area& area, double border_m, Ink ink);
  void disc(double x, double y, double radius_m, Ink ink);
  void triangle(const Area& box, int corner, Ink ink);                   // half of the box, cut along a diagonal
  void text(const Area& line, int characters, Ink ink, Random& random);  // 3 x 5 dot characters, no real letters
  void bar_code(const Area& area, Ink ink, Random& random);
  void darken_border(double border_m, int by);

  double width_m() const { return width_m_; }
  double height_m() const { return height_m_; }
  Texture finish() &&;

 private:
  struct Span {
    int begin = 0, end = 0;
  };
  Span columns(double x, double width) const;
  Span rows(double y, double height) const;
  Texel& at(int x, int y) {
    return texels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
  }

  double width_m_, height_m_;
  int width_, height_;
  double per_m_x_, per_m_y_;
  std::vector<Texel> texels_;
};

}  // namespace povslam::synthetic
