// Landmarks where depth is missing: a feature without depth is searched along its epipolar line in keyframes that look
// at the same place from elsewhere, and the two rays are intersected.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/frontend/map.hpp"
#include "pipeline/geometry/camera.hpp"

namespace povslam {

class Triangulator {
 public:
  Triangulator(const PinholeCamera& camera, const FrontendOptions& options);

  struct Made {
    std::int32_t landmark = kNone;
    int feature = -1;  // of the keyframe
  };
  // Makes landmarks of features of the keyframe that have neither depth nor landmark. Valid until the next call.
  const std::vector<Made>& create(Map& map, std::int32_t keyframe);

 private:
  void with(Map& map, std::int32_t keyframe, std::int32_t other);
  int find_along_line(const Keyframe& other, const Eigen::Vector3d& line, int level,
                      const Descriptor& descriptor) const;
  Eigen::Vector3d ray(const Keyframe& keyframe, int feature) const;
  bool fits(const Keyframe& keyframe, int feature, const Eigen::Vector3d& p_world) const;

  PinholeCamera camera_;
  std::vector<std::int32_t> open_;  // features of the other keyframe that may match
  std::vector<Made> made_;
};

}  // namespace povslam
