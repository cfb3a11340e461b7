# Every third-party library, found once.
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(Boost 1.74 REQUIRED)
find_package(Eigen3 3.4 REQUIRED)
# Debian's single-module OpenCV packages carry no CMake files (only the metapackage with all of OpenCV does).
find_path(OPENCV_INCLUDE opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
function(opencv_module name)
  find_library(OPENCV_${name} opencv_${name} REQUIRED)
  add_library(opencv_${name} INTERFACE IMPORTED GLOBAL)
  target_include_directories(opencv_${name} SYSTEM INTERFACE ${OPENCV_INCLUDE})
  target_link_libraries(opencv_${name} INTERFACE ${OPENCV_${name}} ${ARGN})
endfunction()
opencv_module(core)
opencv_module(imgproc opencv_core)
opencv_module(imgcodecs opencv_imgproc)
find_package(Ceres 2.1 REQUIRED)
find_package(spdlog REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
pkg_check_modules(LCM REQUIRED IMPORTED_TARGET lcm)
pkg_check_modules(SYSTEMD REQUIRED IMPORTED_TARGET libsystemd)

# C++ types generated from daemon/messages/*.lcm.
find_program(LCM_GEN lcm-gen REQUIRED)
file(GLOB lcm_types CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/daemon/messages/*.lcm)
set(lcm_out ${PROJECT_BINARY_DIR}/messages)
if(lcm_types)
add_custom_command(OUTPUT ${lcm_out}/generated.stamp
  COMMAND ${CMAKE_COMMAND} -E make_directory ${lcm_out}
  COMMAND ${LCM_GEN} --cpp --cpp-std=c++11 --cpp-hpath ${lcm_out} ${lcm_types}
  COMMAND ${CMAKE_COMMAND} -E touch ${lcm_out}/generated.stamp
  DEPENDS ${lcm_types} VERBATIM)
add_custom_target(povslam_messages_generated DEPENDS ${lcm_out}/generated.stamp)
else()
add_custom_target(povslam_messages_generated)
endif()
add_library(povslam_messages INTERFACE)
add_dependencies(povslam_messages povslam_messages_generated)
target_include_directories(povslam_messages SYSTEM INTERFACE ${lcm_out})
target_link_libraries(povslam_messages INTERFACE PkgConfig::LCM)
