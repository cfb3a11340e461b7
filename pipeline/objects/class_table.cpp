#include "pipeline/objects/class_table.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string_view>
#include <utility>

namespace povslam {

namespace {

constexpr double kStaticK = 3.0;  // POCD, supplement, table 2: k by s and by whether the geometry agreed

// Colours of neighbouring ids lie the golden angle apart on the circle of hues, so that they differ well.
std::array<std::uint8_t, 3> color_of(std::uint16_t id) {
  if (id == 0) return {0, 0, 0};
  constexpr double kGolden = 0.6180339887498949;
  const double hue = std::fmod(kGolden * id, 1.0) * 6.0;
  const auto channel = [hue](double offset) {
    const double k = std::fmod(offset + hue, 6.0);
    const double share = 1.0 - 0.75 * std::max(0.0, std::min({k, 4.0 - k, 1.0}));
    return static_cast<std::uint8_t>(std::lround(230.0 * share));
  };
  return {channel(5.0), channel(3.0), channel(1.0)};
}

// Things made of parts that stand apart from each other: a word of the name ends so (handcart, pallets, not carton).
bool assembled(const std::string& name) {
  constexpr std::array<std::string_view, 13> kEndings = {"pallet", "forklift", "truck", "cart",  "trolley",
                                                         "ladder", "chair",    "table", "bench", "bicycle",
                                                         "person", "machine",  "robot"};
  constexpr std::array<std::string_view, 3> kPlurals = {"", "s", "es"};
  const auto word_ends = [&](std::size_t at) {
    return at == name.size() || std::isalpha(static_cast<unsigned char>(name[at])) == 0;
  };
  const auto ends_a_word = [&](std::string_view ending) {
    for (std::size_t at = name.find(ending); at != std::string::npos; at = name.find(ending, at + 1)) {
      for (const std::string_view plural : kPlurals) {
        const std::size_t end = at + ending.size();
        if (name.compare(end, plural.size(), plural) == 0 && word_ends(end + plural.size())) return true;
      }
    }
    return false;
  };
  return std::ranges::any_of(kEndings, ends_a_word);
}

}  // namespace

ObjectClass make_class(std::uint16_t id, std::string name, ClassKind kind) {
  ObjectClass row;
  row.id = id;
  row.name = std::move(name);
  row.kind = kind;
  row.k_inlier = is_stationary(kind) ? kStaticK : 0.0;
  row.k_outlier = is_stationary(kind) ? 0.0 : kStaticK;
  row.one_piece = assembled(row.name);
  row.rgb = color_of(id);
  return row;
}

ClassTable geometric_classes() {
  return {"geometric",
          {make_class(0, "unlabelled", ClassKind::ignore),
           make_class(kGeometricStructure, "structure", ClassKind::structure),
           make_class(kGeometricObject, "object", ClassKind::semi_static)}};
}

}  // namespace povslam
