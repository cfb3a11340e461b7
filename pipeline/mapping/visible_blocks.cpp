#include "pipeline/mapping/visible_blocks.hpp"

#include <algorithm>
#include <cmath>

namespace povslam {

namespace {

// Pixels that may be covered by what lies within `half` (along the camera's axes) of a point, within the image; empty
// if none.
PixelBox pixels_of(const PinholeCamera& camera, const Eigen::Vector3f& p_camera, const Eigen::Vector3f& half) {
  const float nearest = p_camera.z() - half.z();
  if (nearest < half.z()) return {0, 0, camera.width, camera.height};
  const float per_depth = 1.0F / p_camera.z(), x = p_camera.x() * per_depth, y = p_camera.y() * per_depth;
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const float per_nearest = 1.0F / nearest;
  const float half_x = fx * (half.x() + std::abs(x) * half.z()) * per_nearest + 1.0F;
  const float half_y = fy * (half.y() + std::abs(y) * half.z()) * per_nearest + 1.0F;
  const float u = fx * x + static_cast<float>(camera.cx), v = fy * y + static_cast<float>(camera.cy);
  const auto within = [](float value, int size) {
    return static_cast<int>(std::clamp(value, 0.0F, static_cast<float>(size)));
  };
  return {within(u - half_x, camera.width), within(v - half_y, camera.height), within(u + half_x + 1.0F, camera.width),
          within(v + half_y + 1.0F, camera.height)};
}

// The largest depth measured in each tile of the image.
class FarthestDepth {
 public:
  explicit FarthestDepth(const ImageF& depth_m)
      : columns_((depth_m.width() + kTile - 1) / kTile),
        farthest_m_(static_cast<std::size_t>(columns_) *
                    static_cast<std::size_t>((depth_m.height() + kTile - 1) / kTile)) {
    std::vector<float> row(static_cast<std::size_t>(columns_) * kTile);
    for (int top = 0; top < depth_m.height(); top += kTile) {
      std::fill(row.begin(), row.end(), 0.0F);
      for (int y = top; y < std::min(top + kTile, depth_m.height()); ++y) {
        const float* depth = depth_m.row(y);
        float* most = row.data();
        for (int x = 0; x < depth_m.width(); ++x) most[x] = depth[x] > most[x] ? depth[x] : most[x];
      }
      for (int k = 0; k < columns_; ++k) {
        at(k, top / kTile) = *std::max_element(row.begin() + k * kTile, row.begin() + (k + 1) * kTile);
      }
    }
  }
  float within(const PixelBox& box) const {
    float most = 0.0F;
    for (int y = box.y0 / kTile; y <= (box.y1 - 1) / kTile; ++y) {
      for (int x = box.x0 / kTile; x <= (box.x1 - 1) / kTile; ++x) most = std::max(most, at(x, y));
    }
    return most;
  }

 private:
  static constexpr int kTile = 32;  // px
  float& at(int x, int y) { return farthest_m_[static_cast<std::size_t>(y * columns_ + x)]; }
  float at(int x, int y) const { return farthest_m_[static_cast<std::size_t>(y * columns_ + x)]; }
  int columns_;
  std::vector<float> farthest_m_;
};

}  // namespace

PixelBox blocks_in_view(const Volume& volume, const DepthView& view, const Rigid3& T_camera_volume,
                        std::vector<BlockInView>& blocks) {
  blocks.clear();
  const auto edge_m = static_cast<float>(kBlockEdge * volume.options().voxel_size_m);
  const Eigen::Matrix3f rotation = T_camera_volume.matrix3().cast<float>() * edge_m;
  // Of the middles of a block's voxels.
  const Eigen::Vector3f half =
      rotation.cwiseAbs() * Eigen::Vector3f::Constant(0.5F * (kBlockEdge - 1.0F) / static_cast<float>(kBlockEdge));
  const Eigen::Vector3f first = T_camera_volume.translation.cast<float>() + rotation * Eigen::Vector3f::Constant(0.5F);
  const auto most = static_cast<float>(view.max_depth_m + volume.options().truncation_m);
  PixelBox all{view.camera.width, view.camera.height, 0, 0};
  for (int index = 0; index < volume.num_blocks(); ++index) {
    const BlockKey& key = volume.key(index);
    const Eigen::Vector3f centre =
        first +
        rotation * Eigen::Vector3f(static_cast<float>(key.x), static_cast<float>(key.y), static_cast<float>(key.z));
    const float nearest_m = centre.z() - half.z();
    if (centre.z() < -half.z() || nearest_m > most) continue;
    const PixelBox box = pixels_of(view.camera, centre, half);
    if (box.columns() <= 0 || box.rows() <= 0) continue;
    blocks.push_back({index, box, nearest_m});
    all = {std::min(all.x0, box.x0), std::min(all.y0, box.y0), std::max(all.x1, box.x1), std::max(all.y1, box.y1)};
  }
  return all;
}

std::vector<int> visible_blocks(const Volume& volume, const DepthView& view, const Rigid3& T_camera_volume) {
  std::vector<BlockInView> in_view;
  blocks_in_view(volume, view, T_camera_volume, in_view);
  const FarthestDepth farthest(view.depth_m);
  const auto truncation_m = static_cast<float>(volume.options().truncation_m);
  std::vector<int> visible;
  for (const BlockInView& block : in_view) {
    const float seen_to = farthest.within(block.box);
    if (seen_to > 0.0F && block.nearest_m <= seen_to + truncation_m) visible.push_back(block.index);
  }
  return visible;
}

VoxelProjection::VoxelProjection(const Volume& volume, const PinholeCamera& camera, const PixelBox& box,
                                 const Rigid3& T_camera_volume)
    : box_(box),
      voxel_size_m_(volume.options().voxel_size_m),
      units_per_m_(kDistanceUnits / volume.options().truncation_m) {
  Eigen::Matrix3d intrinsics;
  intrinsics << camera.fx, 0.0, camera.cx - box.x0, 0.0, camera.fy, camera.cy - box.y0, 0.0, 0.0, 1.0;
  intrinsics *= units_per_m_;
  rotation_ = intrinsics * T_camera_volume.matrix3();
  translation_ = intrinsics * T_camera_volume.translation;
}

BlockRays VoxelProjection::rays() const {
  BlockRays rays{};
  const Eigen::Matrix3d along = rotation_ * voxel_size_m_;
  for (int c = 0; c < 3; ++c) {
    for (int k = 0; k < kBlockEdge * kBlockEdge; ++k) {
      rays.in_slice[c][k] = static_cast<float>(along(c, 0) * (k % kBlockEdge) + along(c, 1) * (k / kBlockEdge));
    }
    rays.next_slice[c] = static_cast<float>(along(c, 2));
  }
  constexpr double kNear_m = 0.02;
  rays.near = static_cast<float>(kNear_m * units_per_m_);
  rays.columns = box_.columns();
  rays.rows = box_.rows();
  return rays;
}

Eigen::Vector3f VoxelProjection::origin(const BlockKey& key) const {
  const Eigen::Vector3d voxel = kBlockEdge * Eigen::Vector3d(key.x, key.y, key.z) + Eigen::Vector3d::Constant(0.5);
  return (rotation_ * (voxel * voxel_size_m_) + translation_).cast<float>();
}

float VoxelProjection::centre_depth_m(const BlockKey& key) const {
  const Eigen::Vector3d centre = kBlockEdge * (Eigen::Vector3d(key.x, key.y, key.z) + Eigen::Vector3d::Constant(0.5));
  return static_cast<float>((rotation_.row(2).dot(centre) * voxel_size_m_ + translation_.z()) / units_per_m_);
}

}  // namespace povslam
