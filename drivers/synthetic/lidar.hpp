// A simulated spinning LiDAR: 16 rings from -15 to 15 degrees, 720 columns a revolution, 10 Hz, counter-clockwise
// from the robot's back. The robot moves during the revolution: each point stands in the LiDAR's frame at its own time.
#pragma once

#include "drivers/synthetic/world.hpp"
#include "pipeline/frames/lidar_frame.hpp"

namespace povslam::synthetic {

class Lidar {
 public:
  static constexpr int kRings = 16, kColumns = 720;
  static constexpr double kRate_hz = 10.0, kMaxRange_m = 30.0;

  explicit Lidar(const World& world) : world_(world) {}

  // The revolution that starts at time_s; the caller owns stamp and seq.
  void scan(double time_s, LidarFrame& frame);

 private:
  struct Target {  // one part of an object, standing in the world
    Eigen::Vector3d center, half_m;
    double sin_yaw = 0.0, cos_yaw = 1.0, radius_m = 0.0;
    float intensity = 0.0F;
  };
  struct Return {
    double range_m = 0.0;
    float intensity = 0.0F;
  };
  void place_targets(double time_s);
  void select(const Eigen::Vector3d& from, const Eigen::Vector3d& direction);
  Return cast(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const;

  const World& world_;
  std::vector<Target> targets_;
  std::vector<const Target*> near_;  // those a column's rays may meet
};

}  // namespace povslam::synthetic
