// How the robot drives: laps on a closed rounded rectangle, its body trembling slightly.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/geometry/rigid.hpp"

namespace povslam::synthetic {

// Closed path, counter-clockwise about the origin: a rectangle whose corners turn with a curvature that rises and
// falls smoothly, so that the yaw rate never jumps.
class LapPath {
 public:
  struct Pose2 {
    double x = 0.0, y = 0.0, yaw = 0.0;  // metres and radians, world; yaw grows by 2 pi a lap
  };

  // Half extents of the rectangle and the arc length of one corner [m]; the corners must fit.
  LapPath(double half_x_m, double half_y_m, double corner_length_m);

  double length_m() const { return length_m_; }
  Pose2 at(double s_m) const;  // starts in the middle of the side at -y, heading +x

 private:
  Pose2 in_corner(double s_m) const;  // from (0, 0), heading +x, turning left

  std::vector<Pose2> corner_;  // every kStep_m
  double corner_length_m_ = 0.0, corner_reach_m_ = 0.0;
  std::array<double, 2> straight_m_{};  // sides along x, along y
  double half_y_m_ = 0.0, length_m_ = 0.0;
};

// Body: x forward, z up, origin on the floor. The camera sits kCameraHeight_m above it and looks along +x.
class RobotMotion {
 public:
  static constexpr double kCameraHeight_m = 0.8;
  static constexpr double kLidarHeight_m = 1.2;

  RobotMotion(LapPath path, double speed_mps, std::uint64_t seed);

  Rigid3 T_world_body(double time_s) const;
  Rigid3 T_world_camera(double time_s) const { return T_world_body(time_s) * T_body_camera(); }
  static Rigid3 T_body_camera();
  static Rigid3 T_body_lidar();

  const LapPath& path() const { return path_; }
  double lap_end_s(double laps) const;  // when so many laps are done

 private:
  struct Wave {
    double amplitude = 0.0, frequency_rad_s = 0.0, phase_rad = 0.0;
  };
  double driven_m(double time_s) const;

  LapPath path_;
  double speed_mps_ = 0.0;
  std::array<std::array<Wave, 3>, 3> waves_{};  // roll [rad], pitch [rad], height [m]
};

}  // namespace povslam::synthetic
