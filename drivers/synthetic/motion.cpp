#include "drivers/synthetic/motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/synthetic/random.hpp"
#include "pipeline/base/expects.hpp"
#include "pipeline/frames/calibration.hpp"

namespace povslam::synthetic {

namespace {

constexpr double kStep_m = 0.01;
constexpr double kSpeedUp_s = 1.5;  // the robot starts from rest

// Curvature rises over the first quarter of a corner, stays, and falls over the last: smoothstep ramps.
double corner_yaw(double s_m, double length_m) {
  constexpr double kRamp = 0.25;
  const double u = s_m / length_m, from_end = std::min(u, 1.0 - u), x = std::min(1.0, from_end / kRamp);
  const double turned = kRamp * x * x * x * (1.0 - 0.5 * x) + std::max(0.0, from_end - kRamp);
  const double share = turned / (1.0 - kRamp);
  return 0.5 * kPi * (u <= 0.5 ? share : 1.0 - share);
}

Eigen::Quaterniond turn(const Eigen::Vector3d& axis, double angle_rad) {
  const SinCos half = sin_cos(0.5 * angle_rad);
  const Eigen::Vector3d v = half.sin * axis;
  return {half.cos, v.x(), v.y(), v.z()};
}

LapPath::Pose2 along(const LapPath::Pose2& from, const LapPath::Pose2& step) {
  const SinCos heading = sin_cos(from.yaw);
  return {from.x + heading.cos * step.x - heading.sin * step.y, from.y + heading.sin * step.x + heading.cos * step.y,
          from.yaw + step.yaw};
}

}  // namespace

LapPath::LapPath(double half_x_m, double half_y_m, double corner_length_m)
    : corner_length_m_(corner_length_m), half_y_m_(half_y_m) {
  const int steps = static_cast<int>(corner_length_m / kStep_m + 0.5);
  const double step = corner_length_m / steps;
  Pose2 pose;
  corner_.push_back(pose);
  for (int i = 0; i < steps; ++i) {  // Simpson's rule on the heading
    const SinCos a = sin_cos(pose.yaw), m = sin_cos(corner_yaw((i + 0.5) * step, corner_length_m));
    pose.yaw = corner_yaw((i + 1) * step, corner_length_m);
    const SinCos b = sin_cos(pose.yaw);
    pose.x += step / 6.0 * (a.cos + 4.0 * m.cos + b.cos);
    pose.y += step / 6.0 * (a.sin + 4.0 * m.sin + b.sin);
    corner_.push_back(pose);
  }
  corner_reach_m_ = pose.x;
  straight_m_ = {2.0 * (half_x_m - corner_reach_m_), 2.0 * (half_y_m - corner_reach_m_)};
  EXPECTS(straight_m_[0] >= 0.0 && straight_m_[1] >= 0.0);
  length_m_ = 2.0 * (straight_m_[0] + straight_m_[1]) + 4.0 * corner_length_m_;
}

LapPath::Pose2 LapPath::in_corner(double s_m) const {
  const double index = s_m / corner_length_m_ * static_cast<double>(corner_.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(index), corner_.size() - 2);
  const double f = index - static_cast<double>(i);
  const Pose2 &a = corner_[i], &b = corner_[i + 1];
  return {a.x + f * (b.x - a.x), a.y + f * (b.y - a.y), corner_yaw(s_m, corner_length_m_)};
}

LapPath::Pose2 LapPath::at(double s_m) const {
  const double lap = std::floor(s_m / length_m_);
  double rest = s_m - lap * length_m_;
  Pose2 pose{0.0, -half_y_m_, 2.0 * kPi * lap};
  for (int piece = 0; piece < 9; ++piece) {
    if (piece % 2 == 1) {
      if (rest <= corner_length_m_) return along(pose, in_corner(rest));
      pose = along(pose, {corner_reach_m_, corner_reach_m_, 0.5 * kPi});
      rest -= corner_length_m_;
      continue;
    }
    const double whole = straight_m_[static_cast<std::size_t>(piece / 2 % 2)];
    const double length = piece == 0 || piece == 8 ? 0.5 * whole : whole;
    if (rest <= length || piece == 8) return along(pose, {rest, 0.0, 0.0});
    pose = along(pose, {length, 0.0, 0.0});
    rest -= length;
  }
  return pose;
}

RobotMotion::RobotMotion(LapPath path, double speed_mps, std::uint64_t seed)
    : path_(std::move(path)), speed_mps_(speed_mps) {
  Random random(mix(seed, 101));
  const std::array<double, 3> amplitude = {0.004, 0.005, 0.003};  // roll, pitch [rad], height [m]
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::array<double, 3> frequency_hz = {random.uniform(0.4, 0.8), random.uniform(1.2, 2.0),
                                                random.uniform(3.0, 5.0)};
    const std::array<double, 3> share = {1.0, 0.4, 0.15};
    for (std::size_t i = 0; i < 3; ++i) {
      waves_[axis][i] = {amplitude[axis] * share[i], 2.0 * kPi * frequency_hz[i], random.uniform(0.0, 2.0 * kPi)};
    }
  }
}

double RobotMotion::driven_m(double time_s) const {
  const double t = std::max(0.0, time_s);
  return t < kSpeedUp_s ? 0.5 * speed_mps_ * t * t / kSpeedUp_s : speed_mps_ * (t - 0.5 * kSpeedUp_s);
}

double RobotMotion::lap_end_s(double laps) const {
  const double distance_m = laps * path_.length_m();
  const double ramp_m = 0.5 * speed_mps_ * kSpeedUp_s;
  return distance_m < ramp_m ? std::sqrt(2.0 * distance_m * kSpeedUp_s / speed_mps_)
                             : distance_m / speed_mps_ + 0.5 * kSpeedUp_s;
}

Rigid3 RobotMotion::T_world_body(double time_s) const {
  const LapPath::Pose2 pose = path_.at(driven_m(time_s));
  std::array<double, 3> tremble{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const Wave& wave : waves_[axis]) {
      tremble[axis] += wave.amplitude * sin_cos(wave.frequency_rad_s * time_s + wave.phase_rad).sin;
    }
  }
  const Eigen::Quaterniond level = turn(Eigen::Vector3d::UnitZ(), pose.yaw);
  return {
      (level * turn(Eigen::Vector3d::UnitY(), tremble[1]) * turn(Eigen::Vector3d::UnitX(), tremble[0])).normalized(),
      {pose.x, pose.y, tremble[2]}};
}

Rigid3 RobotMotion::T_body_camera() {
  return {level_forward_camera().rotation, {0.0, 0.0, kCameraHeight_m}};
}

Rigid3 RobotMotion::T_body_lidar() {
  return {Eigen::Quaterniond::Identity(), {0.0, 0.0, kLidarHeight_m}};
}

}  // namespace povslam::synthetic
