// One LiDAR revolution (or part of one), points in the LiDAR's own frame.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/base/time.hpp"

namespace povslam {

struct LidarPoint {
  float x = 0.0F, y = 0.0F, z = 0.0F;  // metres, lidar frame
  float intensity = 0.0F;              // sensor's own scale
  float t_offset_s = 0.0F;             // time after the frame's stamp
  std::uint16_t ring = 0;
};

struct LidarFrame {
  TimeNs stamp = 0;  // of the first point
  std::uint64_t seq = 0;
  std::vector<LidarPoint> points;  // no entry for a beam without return
};

}  // namespace povslam
