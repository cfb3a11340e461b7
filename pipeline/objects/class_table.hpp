// What kinds of things there are and how they are wont to change. Files: config/classes/*.toml, a recording's
// classes.csv, or the simulator's own.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace povslam {

enum class ClassKind : std::uint8_t {
  ignore,         // no evidence of anything (the robot itself, unknown)
  structure,      // floor, walls, racks: part of the one volume of structure, makes no objects
  static_object,  // an object that hardly ever changes (POCD's s = 1)
  semi_static,    // may change between visits (s = 0)
  dynamic,        // moves while one looks: no object, no map, no landmarks
};

struct ObjectClass {
  std::uint16_t id = 0;
  std::string name;
  ClassKind kind = ClassKind::ignore;
  double prior_alpha = 2.0, prior_beta = 1.0;      // of the consistency, Beta
  double k_inlier = 0.0, k_outlier = 3.0;          // POCD's weight of the class against geometry
  double min_extent_m = 0.05, max_extent_m = 3.0;  // of the box: largest side; what does not fit makes no object
  bool one_piece = false;  // grooves and gaps are its own; else they separate two that stand side by side
  std::array<std::uint8_t, 3> rgb{};
};

inline bool makes_objects(ClassKind kind) {
  return kind == ClassKind::static_object || kind == ClassKind::semi_static;
}

// s of POCD's likelihood.
inline bool is_stationary(ClassKind kind) {
  return kind == ClassKind::static_object || kind == ClassKind::structure;
}

struct ClassTable {
  std::string name;
  std::vector<ObjectClass> classes;

  const ObjectClass* find(std::uint16_t id) const {
    for (const ObjectClass& row : classes) {
      if (row.id == id) return &row;
    }
    return nullptr;
  }
};

// k and prior as POCD sets them for the kind.
ObjectClass make_class(std::uint16_t id, std::string name, ClassKind kind);

// The table of geometric segmentation: 1 "structure", 2 "object".
ClassTable geometric_classes();
inline constexpr std::uint8_t kGeometricStructure = 1;
inline constexpr std::uint8_t kGeometricObject = 2;

}  // namespace povslam
