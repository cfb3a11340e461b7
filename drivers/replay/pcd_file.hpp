// Binary PCD point clouds (Point Cloud Library, version 0.7): fields x y z, intensity, t and ring are used, others are
// skipped. t is seconds after the scan's stamp when it is a float, nanoseconds when it is an integer.
#pragma once

#include <span>
#include <vector>

#include "pipeline/base/result.hpp"
#include "pipeline/frames/lidar_frame.hpp"

namespace povslam {

// Replaces `points`; beams without return (not finite, or at the origin) are left out.
Status decode_pcd(std::span<const char> bytes, std::vector<LidarPoint>& points);

}  // namespace povslam
