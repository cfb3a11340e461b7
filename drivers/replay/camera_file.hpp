// camera.yaml: the calibration of one RGB-D camera, and the presets built in for public recordings.
//
//   width: 640                     px
//   height: 480
//   fx: 517.3                      px; fy, cx, cy likewise
//   distortion: [k1, k2, p1, p2, k3]      optional, default none
//   depth_scale: 5000              depth units per metre
//   fps: 30                        Hz, optional
//   rolling_shutter_s: 0.026       s from the first row's exposure to the last row's, optional, default 0
//   gravity_world: [0, 0, -1]      which way is down in the world of groundtruth.txt, optional
// A depth camera that is not registered to colour (its depth is then warped into the colour camera when read):
//   depth_width, depth_height      px, optional, default as colour
//   depth_fx, depth_fy, depth_cx, depth_cy   px, no distortion
//   T_color_depth: {translation: [x, y, z], q_xyzw: [x, y, z, w]}   p_color = T_color_depth * p_depth, metres
// An unknown or repeated key or a bad value is an error that names file and line. yaml-cpp's door.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/base/result.hpp"
#include "pipeline/geometry/camera.hpp"
#include "pipeline/geometry/rigid.hpp"

namespace povslam {

struct DepthCamera {
  PinholeCamera camera;  // undistorted
  Rigid3 T_color_depth;
};

struct CameraFile {
  PinholeCamera color;
  double depth_scale = 1000.0;  // units per metre
  double fps = 30.0;            // Hz
  double rolling_shutter_s = 0.0;
  std::optional<Eigen::Vector3d> gravity_world;
  std::optional<DepthCamera> depth;  // nothing: depth is registered to colour
};

Result<CameraFile> read_camera_file(const std::filesystem::path& path);
// name: as in messages, in place of a path.
Result<CameraFile> parse_camera(const std::string& yaml, const std::string& name);

// A preset's name, or the path of a camera.yaml. Neither: an error that lists the presets.
Result<CameraFile> find_camera(const std::string& preset_or_path);
std::vector<std::string> camera_preset_names();

// sensors.yaml: keys T_body_<sensor>: {translation, q_xyzw}. Sensor name -> T_body_sensor.
Result<std::map<std::string, Rigid3>> read_sensors_file(const std::filesystem::path& path);

}  // namespace povslam
