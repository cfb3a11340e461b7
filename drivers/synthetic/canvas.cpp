#include "drivers/synthetic/canvas.hpp"

#include <array>
#include <utility>

namespace povslam::synthetic {

namespace {

// A multiple of 64, so that six halvings lose nothing: were a texel dropped on the way, prints would creep over the
// surface as the camera comes nearer.
int texel_count(double size_m, double texels_per_m) {
  constexpr int kStep = 64;
  const int wanted = static_cast<int>(size_m * texels_per_m / kStep + 0.5) * kStep;
  return std::clamp(wanted, kStep, Texture::kMaxSide / kStep * kStep);
}

Texel to_texel(Ink ink) {
  return make_texel(ink.red, ink.green, ink.blue);
}

}  // namespace

Canvas::Canvas(double width_m, double height_m, double texels_per_m)
    : width_m_(width_m),
      height_m_(height_m),
      width_(texel_count(width_m, texels_per_m)),
      height_(texel_count(height_m, texels_per_m)),
      per_m_x_(width_ / width_m),
      per_m_y_(height_ / height_m) {
  texels_.reserve(Texture::num_texels(width_, height_));  // once for the picture and its smaller ones
  texels_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
}

Canvas::Span Canvas::columns(double x, double width) const {
  const auto at = [this](double m) { return std::clamp(static_cast<int>(m * per_m_x_ + 0.5), 0, width_); };
  return {at(x), at(x + width)};
}

Canvas::Span Canvas::rows(double y, double height) const {
  const auto at = [this](double m) { return std::clamp(static_cast<int>(m * per_m_y_ + 0.5), 0, height_); };
  return {at(y), at(y + height)};
}

void Canvas::base(Ink ink, double cloudiness, Random& random) {
  constexpr int kGrid = 5;
  std::array<double, kGrid * kGrid> cloud{};
  for (double& value : cloud) value = random.uniform(-cloudiness, cloudiness);
  for (int y = 0; y < height_; ++y) {
    const double v = static_cast<double>(y) / height_ * (kGrid - 1);
    const int row = static_cast<int>(v);
    std::array<double, kGrid> line{};
    for (int i = 0; i < kGrid; ++i) {
      const double a = cloud[static_cast<std::size_t>(row * kGrid + i)];
      const double b = cloud[static_cast<std::size_t>((row + 1) * kGrid + i)];
      line[static_cast<std::size_t>(i)] = a + (v - row) * (b - a);
    }
    for (int x = 0; x < width_; ++x) {
      const double u = static_cast<double>(x) / width_ * (kGrid - 1);
      const auto i = static_cast<std::size_t>(u);
      const double shade = line[i] + (u - static_cast<double>(i)) * (line[i + 1] - line[i]);
      at(x, y) = to_texel(ink.lighter(static_cast<int>(shade + 1000.5) - 1000));
    }
  }
}

void Canvas::rectangle(const Area& area, Ink ink) {
  const Span across = columns(area.x, area.width), down = rows(area.y, area.height);
  const Texel texel = to_texel(ink);
  for (int y = down.begin; y < down.end; ++y) {
    for (int x = across.begin; x < across.end; ++x) at(x, y) = texel;
  }
}

void Canvas::frame(const Area& area, double border_m, Ink ink) {
  rectangle({area.x, area.y, area.width, border_m}, ink);
  rectangle({area.x, area.y + area.height - border_m, area.width, border_m}, ink);
  rectangle({area.x, area.y, border_m, area.height}, ink);
  rectangle({area.x + area.width - border_m, area.y, border_m, area.height}, ink);
}

void Canvas::disc(double x, double y, double radius_m, Ink ink) {
  const Span across = columns(x - radius_m, 2.0 * radius_m), down = rows(y - radius_m, 2.0 * radius_m);
  const Texel texel = to_texel(ink);
  for (int row = down.begin; row < down.end; ++row) {
    for (int column = across.begin; column < across.end; ++column) {
      const double dx = (column + 0.5) / per_m_x_ - x, dy = (row + 0.5) / per_m_y_ - y;
      if (dx * dx + dy * dy <= radius_m * radius_m) at(column, row) = texel;
    }
  }
}

void Canvas::triangle(const Area& box, int corner, Ink ink) {
  const Span across = columns(box.x, box.width), down = rows(box.y, box.height);
  const Texel texel = to_texel(ink);
  for (int y = down.begin; y < down.end; ++y) {
    for (int x = across.begin; x < across.end; ++x) {
      double u = ((x + 0.5) / per_m_x_ - box.x) / box.width, v = ((y + 0.5) / per_m_y_ - box.y) / box.height;
      if (corner & 1) u = 1.0 - u;
      if (corner & 2) v = 1.0 - v;
      if (u + v <= 1.0) at(x, y) = texel;
    }
  }
}

void Canvas::text(const Area& line, int characters, Ink ink, Random& random) {
  const double dot_x = line.width / (4.0 * characters), dot_y = line.height / 5.0;
  for (int c = 0; c < characters; ++c) {
    if (c > 0 && random.chance(0.12)) continue;  // a space
    for (int dot = 0; dot < 15; ++dot) {
      if (random.chance(0.42)) continue;
      rectangle({line.x + (4.0 * c + dot % 3) * dot_x, line.y + (dot / 3) * dot_y, dot_x, dot_y}, ink);
    }
  }
}

void Canvas::bar_code(const Area& area, Ink ink, Random& random) {
  for (double x = 0.0; x < area.width;) {
    const double bar = area.width * random.uniform(0.012, 0.05);
    rectangle({area.x + x, area.y, std::min(bar, area.width - x), area.height}, ink);
    x += bar + area.width * random.uniform(0.012, 0.05);
  }
}

void Canvas::darken_border(double border_m, int by) {
  const Span left = columns(0.0, border_m), top = rows(0.0, border_m);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const bool inside = x >= left.end && x < width_ - left.end && y >= top.end && y < height_ - top.end;
      if (inside) continue;
      const Rgb rgb = from_lanes(to_lanes(at(x, y)));
      at(x, y) = make_texel(rgb.red - by, rgb.green - by, rgb.blue - by);
    }
  }
}

Texture Canvas::finish() && {
  return {width_, height_, std::move(texels_)};
}

}  // namespace povslam::synthetic
