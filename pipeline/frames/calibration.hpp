// What is known of each sensor before the first frame.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/geometry/camera.hpp"
#include "pipeline/geometry/rigid.hpp"

namespace povslam {

enum class SensorKind : std::uint8_t { rgbd, lidar, labels };

struct SensorCalibration {
  std::string name;  // role on the robot: "front", "left", "top_lidar"
  SensorKind kind = SensorKind::rgbd;
  PinholeCamera camera;            // rgbd: the colour camera; depth is registered to it
  double depth_scale = 1000.0;     // rgbd: units per metre
  double fps = 30.0;               // nominal rate [Hz]
  double rolling_shutter_s = 0.0;  // rgbd: the last row is read this long after the first; 0 = all rows at once
  Rigid3 T_body_sensor;            // body: x forward, z up; camera: x right, y down, z forward
};

// T_body_camera of a level camera that looks along the body's +x: q_xyzw = (-0.5, 0.5, -0.5, 0.5), t = 0.
inline Rigid3 level_forward_camera() {
  return {Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), Eigen::Vector3d::Zero()};
}

}  // namespace povslam
