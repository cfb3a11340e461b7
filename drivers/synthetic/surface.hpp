// Points on the true surfaces of the final arrangement: the reference that maps are scored against.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "drivers/synthetic/scene.hpp"

namespace povslam::synthetic {

struct SurfacePoint {  // world frame
  Eigen::Vector3f at, normal;
};

// About spacing_m apart, the edges of faces included. The floor, faces that stand on it, people and what lies inside
// other boxes are left out.
std::vector<SurfacePoint> final_surface(const Scene& scene, double spacing_m);

}  // namespace povslam::synthetic
