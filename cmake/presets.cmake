# Camera presets: the texts of config/presets/*.yaml become drivers/replay's camera_presets().
file(GLOB preset_files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/config/presets/*.yaml)
set(preset_rows "")
foreach(preset ${preset_files})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${preset})
  get_filename_component(name ${preset} NAME_WE)
  file(READ ${preset} text)
  string(APPEND preset_rows "    {\"${name}\", R\"yaml(${text})yaml\"},\n")
endforeach()
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/camera_presets.cpp @ONLY CONTENT [[
#include "drivers/replay/camera_presets.hpp"

namespace povslam {

namespace {
constexpr CameraPreset kPresets[] = {
@preset_rows@};
}

std::span<const CameraPreset> camera_presets() { return kPresets; }

}  // namespace povslam
]])
target_sources(povslam_drivers PRIVATE ${PROJECT_BINARY_DIR}/camera_presets.cpp)
