// The texts of config/presets/*.yaml, built into the library (cmake/presets.cmake), so that an installed program has
// them.
#pragma once

#include <span>

namespace povslam {

struct CameraPreset {
  const char* name;
  const char* yaml;
};

std::span<const CameraPreset> camera_presets();

}  // namespace povslam
