// The texts of config/classes/*.toml, built into the library (cmake/presets.cmake), so that an installed program has
// them.
#pragma once

#include <span>

namespace povslam {

struct ClassPreset {
  const char* name;
  const char* toml;
};

std::span<const ClassPreset> class_presets();

}  // namespace povslam
