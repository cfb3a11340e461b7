// Slopes of inverse depth, and from them points and normals.
#include <algorithm>
#include <cmath>

#include "pipeline/objects/segment_grid.hpp"

namespace povslam {

namespace {

constexpr int kReach = 3;  // cells to each side for a slope

// Over both sides where w runs on evenly, else over the side that is closer: the other lies across an edge.
float slope(const float* w, int stride, float even) {
  const float before = w[-kReach * stride], here = w[0], after = w[kReach * stride];
  const bool has_before = before > 0.0F, has_after = after > 0.0F;
  const float rise = after - here, fall = here - before;
  if (has_before && has_after) {
    if (std::abs(rise - fall) < even) return (after - before) / (2.0F * kReach);
    return (std::abs(rise) < std::abs(fall) ? rise : fall) / kReach;
  }
  if (has_before) return fall / kReach;
  if (has_after) return rise / kReach;
  const bool near_before = w[-stride] > 0.0F, near_after = w[stride] > 0.0F;
  if (near_before && near_after) return 0.5F * (w[stride] - w[-stride]);
  return near_before ? here - w[-stride] : near_after ? w[stride] - here : 0.0F;
}

}  // namespace

void find_surfaces(const Rigid3& T_world_camera, const SegmentOptions& options, SegmentGrid& grid) {
  const Eigen::Matrix3f R = T_world_camera.matrix3().cast<float>();
  const auto camera_z = static_cast<float>(T_world_camera.translation.z());
  const float noise = static_cast<float>(options.jump_sigmas) * smooth_sigma(options, grid);
  for (int row = 0; row < grid.height; ++row) {
    const float v = (static_cast<float>(row) - grid.center_y) / grid.focal_y;
    for (int column = 0; column < grid.width; ++column) {
      const auto i = static_cast<std::size_t>(grid.index(column, row));
      const float w = grid.w[i];
      if (w <= 0.0F) continue;
      const float even = noise + static_cast<float>(options.jump_share) * w;
      const float sx = slope(&grid.w[i], 1, even), sy = slope(&grid.w[i], grid.stride, even);
      const float u = (static_cast<float>(column) - grid.center_x) / grid.focal_x, depth = 1.0F / w;
      const Eigen::Vector3f p = R * Eigen::Vector3f(u * depth, v * depth, depth);
      // n . ray = distance * w: the slopes of w over the image are the plane's own coefficients.
      const float a = sx * grid.focal_x, b = sy * grid.focal_y;
      const Eigen::Vector3f n = -(R * Eigen::Vector3f(a, b, w - u * a - v * b)).normalized();
      grid.slope_x[i] = sx;
      grid.slope_y[i] = sy;
      grid.x[i] = p.x();
      grid.y[i] = p.y();
      grid.z[i] = p.z() + camera_z;
      grid.normal_x[i] = n.x();
      grid.normal_y[i] = n.y();
      grid.normal_z[i] = n.z();
    }
  }
}

}  // namespace povslam
