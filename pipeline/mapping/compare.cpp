#include "pipeline/mapping/compare.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/mapping/kernels/dispatch.hpp"
#include "pipeline/mapping/visible_blocks.hpp"

namespace povslam {

namespace {

constexpr float kFacingCosine = 0.2588F;  // 75 degrees
constexpr float kBeyondCap_m = 1.0F;

struct Around {  // of the depths measured in the 3 x 3 pixels around one, against an expected one
  int beyond = 0, before = 0, agree = 0;
  float nearest_m = 1e9F;
};

Around measured_around(const ImageF& depth_m, int column, int row, float least_m, float most_m) {
  Around around;
  const int left = std::max(column - 1, 0), right = std::min(column + 1, depth_m.width() - 1);
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, depth_m.height() - 1); ++y) {
    const float* depth = depth_m.row(y);
    for (int x = left; x <= right; ++x) {
      if (!(depth[x] > 0.0F)) continue;
      around.nearest_m = std::min(around.nearest_m, depth[x]);
      around.beyond += depth[x] > most_m;
      around.before += depth[x] < least_m;
      around.agree += depth[x] >= least_m && depth[x] <= most_m;
    }
  }
  return around;
}

}  // namespace

DistanceComparison compare_distances(const Volume& volume, const DepthView& view, const Rigid3& T_world_volume) {
  const Rigid3 T_camera_volume = view.T_world_camera.inverse() * T_world_volume;
  const std::vector<int> visible = visible_blocks(volume, view, T_camera_volume);
  const VoxelProjection projection(volume, view.camera, {0, 0, view.camera.width, view.camera.height}, T_camera_volume);
  const double truncation_m = volume.options().truncation_m;
  const ComparePass pass{projection.rays(), view.depth_m.data(), static_cast<float>(kDistanceUnits / truncation_m)};
  CompareSum sum{0, 0};
  for (const int index : visible) {
    const VoxelBlock& block = volume.block(index);
    const Eigen::Vector3f origin = projection.origin(block.key);
    const CompareSum one =
        mapping_kernels().compare_block(&pass, origin.data(), block.distance.data(), block.weight.data());
    sum.voxels += one.voxels;
    sum.difference_units += one.difference_units;
  }
  if (sum.voxels == 0) return {};
  return {static_cast<int>(sum.voxels),
          static_cast<double>(sum.difference_units) / static_cast<double>(sum.voxels) * truncation_m / kDistanceUnits};
}

namespace {

PointLook judge(const Around& around) {
  if (around.agree > 0) return PointLook::agrees;
  if (around.beyond > 0 && around.before == 0) return PointLook::seen_through;
  if (around.before > 0 && around.beyond == 0) return PointLook::hidden;
  return PointLook::nothing;
}

// visit(index of the point, what it says, how far beyond it the nearest depth is) for those that face the camera.
template <class Visit>
void visit_facing(std::span<const SurfacePoint> surface, const DepthView& view, const Rigid3& T_world_volume,
                  double margin_m, const DepthNoise& noise, const Visit& visit) {
  const Rigid3 T_camera_volume = view.T_world_camera.inverse() * T_world_volume;
  const Eigen::Matrix3f rotation = T_camera_volume.matrix3().cast<float>();
  const Eigen::Vector3f translation = T_camera_volume.translation.cast<float>();
  const auto fx = static_cast<float>(view.camera.fx), fy = static_cast<float>(view.camera.fy);
  const auto cx = static_cast<float>(view.camera.cx), cy = static_cast<float>(view.camera.cy);
  const auto width = static_cast<float>(view.camera.width), height = static_cast<float>(view.camera.height);
  const auto least_m = static_cast<float>(std::max(view.min_depth_m, 1e-3)),
             most_m = static_cast<float>(view.max_depth_m);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Eigen::Vector3f p = rotation * surface[i].p_volume + translation;
    if (!(p.z() >= least_m && p.z() <= most_m)) continue;
    if (-(rotation * surface[i].normal).dot(p) < kFacingCosine * p.norm()) continue;
    const float u = fx * p.x() / p.z() + cx + 0.5F, v = fy * p.y() / p.z() + cy + 0.5F;
    if (!(u >= 0.0F && v >= 0.0F && u < width && v < height)) continue;
    const float sigma = static_cast<float>(std::hypot(noise.quadratic_per_m * p.z() * p.z(), noise.floor_m));
    const float clearly_m = static_cast<float>(margin_m) + 3.0F * sigma;
    const Around around =
        measured_around(view.depth_m, static_cast<int>(u), static_cast<int>(v), p.z() - clearly_m, p.z() + clearly_m);
    visit(i, judge(around), around.nearest_m - p.z());
  }
}

}  // namespace

SurfaceLook look_at(std::span<const SurfacePoint> surface, const DepthView& view, const Rigid3& T_world_volume,
                    double margin_m, const DepthNoise& noise) {
  SurfaceLook look;
  double beyond_sum_m = 0.0;
  visit_facing(surface, view, T_world_volume, margin_m, noise, [&](std::size_t, PointLook says, float beyond_m) {
    ++look.facing;
    look.agree += says == PointLook::agrees ? 1 : 0;
    look.hidden += says == PointLook::hidden ? 1 : 0;
    if (says != PointLook::seen_through) return;
    ++look.seen_through;
    beyond_sum_m += static_cast<double>(std::min(beyond_m, kBeyondCap_m));
  });
  if (look.seen_through > 0) look.mean_beyond_m = beyond_sum_m / look.seen_through;
  return look;
}

std::vector<PointLook> look_at_each(std::span<const SurfacePoint> surface, const DepthView& view,
                                    const Rigid3& T_world_volume, double margin_m, const DepthNoise& noise) {
  std::vector<PointLook> looks(surface.size(), PointLook::nothing);
  visit_facing(surface, view, T_world_volume, margin_m, noise,
               [&](std::size_t i, PointLook says, float) { looks[i] = says; });
  return looks;
}

}  // namespace povslam
