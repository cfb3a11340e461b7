#include "drivers/synthetic/paint.hpp"

#include <array>
#include <utility>

#include "drivers/synthetic/canvas.hpp"

namespace povslam::synthetic {

namespace {

constexpr Ink kBlack{28, 26, 30};
constexpr Ink kWhite{228, 226, 220};
constexpr std::array<Ink, 8> kCartons = {{{168, 128, 88},
                                          {150, 112, 74},
                                          {188, 152, 112},
                                          {132, 104, 80},
                                          {176, 172, 164},
                                          {112, 132, 150},
                                          {138, 150, 118},
                                          {176, 140, 120}}};
constexpr std::array<Ink, 8> kPrints = {{{34, 58, 128},
                                         {158, 34, 36},
                                         {30, 96, 60},
                                         {36, 34, 36},
                                         {214, 136, 28},
                                         {96, 40, 110},
                                         {226, 222, 210},
                                         {20, 110, 130}}};

template <std::size_t N>
Ink pick(const std::array<Ink, N>& inks, Random& random) {
  return inks[static_cast<std::size_t>(random.below(static_cast<int>(N)))].lighter(random.below(25) - 12);
}

Area somewhere(const Canvas& canvas, double width, double height, Random& random) {
  width = std::min(width, 0.9 * canvas.width_m());
  height = std::min(height, 0.9 * canvas.height_m());
  return {random.uniform(0.0, canvas.width_m() - width), random.uniform(0.0, canvas.height_m() - height), width,
          height};
}

void print_label(Canvas& canvas, double scale, Random& random) {
  const Area label = somewhere(canvas, scale * random.uniform(0.18, 0.34), scale * random.uniform(0.12, 0.24), random);
  canvas.rectangle(label, random.chance(0.8) ? kWhite.lighter(-random.below(30)) : Ink{220, 190, 60});
  if (random.chance(0.6)) canvas.frame(label, 0.006 * scale, kBlack);
  const double margin = 0.08 * label.width, inner = label.width - 2.0 * margin;
  const int lines = 3 + random.below(3);
  const double pitch = (label.height - 2.0 * margin) / lines;
  for (int i = 0; i < lines; ++i) {
    const Area line{label.x + margin, label.y + margin + i * pitch, inner * random.uniform(0.5, 1.0), 0.62 * pitch};
    if (i == 1 && random.chance(0.6)) {
      canvas.bar_code({line.x, line.y, inner, pitch}, kBlack, random);
      ++i;
    } else {
      canvas.text(line, 5 + random.below(8), kBlack, random);
    }
  }
}

void print_patch(Canvas& canvas, double size, Random& random) {
  const Area area = somewhere(canvas, size * random.uniform(0.6, 1.6), size * random.uniform(0.6, 1.6), random);
  const Ink ink = pick(kPrints, random);
  switch (random.below(5)) {
    case 0:
      return canvas.rectangle(area, ink);
    case 1:
      return canvas.frame(area, 0.22 * std::min(area.width, area.height), ink);
    case 2:
      return canvas.disc(area.x + 0.5 * area.width, area.y + 0.5 * area.height, 0.45 * size, ink);
    case 3:
      return canvas.triangle(area, random.below(4), ink);
    default:
      return canvas.text(area, 1 + random.below(3), ink, random);
  }
}

void print_carton(Canvas& canvas, double scale, Random& random) {
  const double area_share = canvas.width_m() * canvas.height_m() / (scale * scale);
  canvas.base(pick(kCartons, random), 10.0, random);
  if (random.chance(0.6)) {
    const Ink tape = Ink{196, 176, 130}.lighter(random.below(40) - 20);
    const double strip = 0.06 * scale;
    if (random.chance(0.5))
      canvas.rectangle({0.0, random.uniform(0.3, 0.6) * canvas.height_m(), canvas.width_m(), strip}, tape);
    else
      canvas.rectangle({random.uniform(0.3, 0.6) * canvas.width_m(), 0.0, strip, canvas.height_m()}, tape);
  }
  const int big = 1 + random.below(2);
  for (int i = 0; i < big; ++i) print_patch(canvas, scale * random.uniform(0.2, 0.35), random);
  canvas.text(somewhere(canvas, scale * random.uniform(0.4, 0.7), scale * random.uniform(0.1, 0.2), random),
              4 + random.below(4), pick(kPrints, random), random);
  for (int i = 0; i < static_cast<int>(10.0 * area_share) + 3; ++i)
    print_patch(canvas, scale * random.uniform(0.04, 0.12), random);
  for (int i = 0; i < static_cast<int>(3.0 * area_share) + 1; ++i) print_label(canvas, scale, random);
  for (int i = 0; i < static_cast<int>(30.0 * area_share) + 5; ++i)
    print_patch(canvas, scale * random.uniform(0.012, 0.04), random);
  canvas.darken_border(0.01 * scale, 30);
}

void print_wood(Canvas& canvas, Random& random) {
  canvas.base(Ink{150, 116, 78}.lighter(random.below(30) - 15), 12.0, random);
  for (int i = 0; i < 8; ++i) print_patch(canvas, random.uniform(0.01, 0.03), random);
}

void print_wall(Canvas& canvas, Random& random) {
  canvas.base({148, 150, 148}, 8.0, random);
  canvas.rectangle({0.0, 0.68 * canvas.height_m(), canvas.width_m(), 0.12}, {186, 160, 50});
  for (int i = 0; i < static_cast<int>(1.6 * canvas.width_m()); ++i)
    print_label(canvas, random.uniform(1.0, 3.0), random);
  for (int i = 0; i < static_cast<int>(8.0 * canvas.width_m()); ++i)
    print_patch(canvas, random.uniform(0.03, 0.2), random);
}

void print_pillar(Canvas& canvas, Random& random) {
  canvas.base({140, 138, 134}, 10.0, random);
  canvas.rectangle({0.0, 0.62 * canvas.height_m(), canvas.width_m(), 0.1 * canvas.height_m()}, {200, 170, 40});
  for (int i = 0; i < 14; ++i) print_patch(canvas, random.uniform(0.03, 0.12), random);
}

void print_truck(Canvas& canvas, Random& random) {
  canvas.base({206, 140, 30}, 8.0, random);
  for (int i = 0; i < 12; ++i) print_patch(canvas, random.uniform(0.03, 0.2), random);
  print_label(canvas, 0.8, random);
}

void print_cloth(Canvas& canvas, Random& random) {
  canvas.base(pick(kPrints, random), 14.0, random);
  canvas.rectangle({0.0, 0.25 * canvas.height_m(), canvas.width_m(), 0.06 * canvas.height_m()}, {214, 220, 90});
}

void print_steel(Canvas& canvas, Random& random) {
  canvas.base(Ink{52, 78, 130}.lighter(random.below(20) - 10), 6.0, random);
  for (int i = 0; i < 4; ++i) print_patch(canvas, random.uniform(0.02, 0.05), random);
}

struct Stock {  // how finely a material is printed, and with what
  double texels_per_m, max_texels;
  void (*print)(Canvas&, Random&);
};

Stock stock_of(Paint paint) {
  switch (paint) {
    case Paint::carton:
      return {320.0, 288.0, [](Canvas& canvas, Random& random) { print_carton(canvas, 1.0, random); }};
    case Paint::goods:
      return {280.0, 128.0, [](Canvas& canvas, Random& random) { print_carton(canvas, 0.5, random); }};
    case Paint::wood:
      return {150.0, 192.0, print_wood};
    case Paint::wall:
      return {100.0, 1800.0, print_wall};
    case Paint::concrete:
      return {150.0, 480.0, print_pillar};
    case Paint::truck:
      return {160.0, 256.0, print_truck};
    case Paint::cloth:
      return {120.0, 128.0, print_cloth};
    case Paint::steel:
      break;
  }
  return {60.0, 256.0, print_steel};
}

}  // namespace

Texture paint_face(Paint paint, double width_m, double height_m, std::uint64_t seed) {
  const Stock stock = stock_of(paint);
  Random random(mix(seed, 202));
  Canvas canvas(width_m, height_m, std::min(stock.texels_per_m, stock.max_texels / std::max(width_m, height_m)));
  stock.print(canvas, random);
  return std::move(canvas).finish();
}

}  // namespace povslam::synthetic
