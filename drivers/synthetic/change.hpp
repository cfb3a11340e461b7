// When things may change: never while the robot looks.
#pragma once

#include <optional>
#include <vector>

#include "drivers/synthetic/raster.hpp"
#include "drivers/synthetic/scene.hpp"

namespace povslam::synthetic {

// Tells by ray casting with a coarse, slightly wider camera what the robot can see from its path.
class Watch {
 public:
  Watch(const PinholeCamera& camera, const RobotMotion& motion);

  // Whether anything of the object, standing there and 3 cm larger, is seen at that time. Only objects that never
  // change or walk hide it.
  bool sees(const std::vector<Object>& objects, std::size_t index, const Placement& placement, double time_s);

  struct Coverage {
    double least_share = 1.0;  // of the image filled by objects within reach, at the worst pose
    int least_objects = 0;     // of at least 1 % of the image each, at the worst pose
  };
  // Over a whole lap, the objects standing as before (time 0) or after their change.
  Coverage coverage(const std::vector<Object>& objects, bool after, double reach_m);

 private:
  const RobotMotion& motion_;
  PinholeCamera wide_, exact_;
  Raster raster_;
  std::vector<ProjectedFace> faces_;
};

// The latest moment not after the end of the first lap at which neither place of the object is in view (nor 0.2 s
// earlier or later); failing that the first one after it.
std::optional<double> find_switch_time(const std::vector<Object>& objects, std::size_t index, const RobotMotion& motion,
                                       Watch& watch);

// Sets switch_time_s of all that change; false: one of them has no such moment.
bool time_changes(std::vector<Object>& objects, const RobotMotion& motion, Watch& watch);

}  // namespace povslam::synthetic
