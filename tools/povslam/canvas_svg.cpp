#include <cstdio>
#include <fstream>

#include "tools/povslam/canvas.hpp"

namespace povslam::drawing {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

std::string hex(Color color) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", color.red, color.green, color.blue);
  return text;
}

std::string escape(const std::string& text) {
  std::string safe;
  for (const char letter : text) {
    switch (letter) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      default:
        safe += letter;
    }
  }
  return safe;
}

const char* name(Anchor anchor) {
  switch (anchor) {
    case Anchor::left:
      return "start";
    case Anchor::middle:
      return "middle";
    case Anchor::right:
      return "end";
  }
  return "start";
}

class SvgCanvas : public Canvas {
 public:
  SvgCanvas(int width_px, int height_px) {
    const std::string width = std::to_string(width_px), height = std::to_string(height_px);
    body_ = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + width + "\" height=\"" + height +
            "\" viewBox=\"0 0 " + width + " " + height + "\" font-family=\"Helvetica, Arial, sans-serif\">\n";
    rectangle({0.0, 0.0}, {double(width_px), double(height_px)}, {255, 255, 255});
  }

  void polyline(std::span<const Eigen::Vector2d> points_px, const Stroke& stroke) override {
    body_ += "<polyline fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\" stroke=\"" +
             hex(stroke.color) + "\" stroke-width=\"" + number(stroke.width_px) + "\" points=\"";
    for (const Eigen::Vector2d& p_px : points_px) body_ += number(p_px.x()) + "," + number(p_px.y()) + " ";
    body_ += "\"/>\n";
  }

  void rectangle(const Eigen::Vector2d& corner_px, const Eigen::Vector2d& size_px, Color fill) override {
    body_ += "<rect x=\"" + number(corner_px.x()) + "\" y=\"" + number(corner_px.y()) + "\" width=\"" +
             number(size_px.x()) + "\" height=\"" + number(size_px.y()) + "\" fill=\"" + hex(fill) + "\"/>\n";
  }

  void dot(const Eigen::Vector2d& centre_px, double radius_px, Color fill) override {
    body_ += "<circle cx=\"" + number(centre_px.x()) + "\" cy=\"" + number(centre_px.y()) + "\" r=\"" +
             number(radius_px) + "\" fill=\"" + hex(fill) + "\"/>\n";
  }

  void text(const Eigen::Vector2d& baseline_px, const std::string& text, const TextStyle& style) override {
    body_ += "<text x=\"" + number(baseline_px.x()) + "\" y=\"" + number(baseline_px.y()) + "\" font-size=\"" +
             number(style.size_px) + "\" fill=\"" + hex(style.color) + "\" text-anchor=\"" + name(style.anchor) +
             "\" xml:space=\"preserve\"" + (style.bold ? " font-weight=\"bold\"" : "") + ">" + escape(text) +
             "</text>\n";
  }

  Status save(const std::string& file) const override {
    std::ofstream out(file, std::ios::binary);
    out << body_ << "</svg>\n";
    out.close();
    if (!out) return Error{file + ": cannot write the picture; does its folder exist and may it be written to?"};
    return Done{};
  }

 private:
  std::string body_;
};

}  // namespace

std::unique_ptr<Canvas> make_svg_canvas(int width_px, int height_px) {
  return std::make_unique<SvgCanvas>(width_px, height_px);
}

}  // namespace povslam::drawing
