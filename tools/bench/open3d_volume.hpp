// Open3D's VoxelBlockGrid (0.16) fed with our views. Only where CMake finds Open3D (see tsdf_bench.cpp).
#pragma once

#include <open3d/Open3D.h>

#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/frames/rgbd_frame.hpp"
#include "pipeline/mapping/depth_view.hpp"
#include "pipeline/mapping/volume.hpp"

namespace povslam {

class Open3dVolume {
 public:
  // It keeps weights as integers only together with colours.
  Open3dVolume(const VolumeOptions& options, bool color)
      : truncation_voxels_(static_cast<float>(options.truncation_m / options.voxel_size_m)),
        color_(color),
        grid_(
            color ? std::vector<std::string>{"tsdf", "weight", "color"} : std::vector<std::string>{"tsdf", "weight"},
            color ? std::vector<open3d::core::Dtype>{open3d::core::Float32, open3d::core::UInt16, open3d::core::UInt16}
                  : std::vector<open3d::core::Dtype>{open3d::core::Float32, open3d::core::Float32},
            color ? std::vector<open3d::core::SizeVector>{{1}, {1}, {3}}
                  : std::vector<open3d::core::SizeVector>{{1}, {1}},
            static_cast<float>(options.voxel_size_m), kBlockEdge, options.max_blocks, open3d::core::Device("CPU:0")) {}

  struct Frame {
    open3d::t::geometry::Image depth, color;
    open3d::core::Tensor intrinsic, extrinsic;
    float depth_scale, max_depth_m;
  };
  // It takes the pixel that a point falls into with (0, 0) at the corner of the first one, we the nearest middle.
  static Frame frame(const RgbdFrame& rgbd, const DepthView& view) {
    const PinholeCamera& c = view.camera;
    const Rigid3 T_camera_world = view.T_world_camera.inverse();
    Eigen::Matrix4d extrinsic = Eigen::Matrix4d::Identity();
    extrinsic.topLeftCorner<3, 3>() = T_camera_world.matrix3();
    extrinsic.topRightCorner<3, 1>() = T_camera_world.translation;
    const auto size = [&](std::int64_t channels) { return open3d::core::SizeVector{c.height, c.width, channels}; };
    return {open3d::core::Tensor(rgbd.depth.data(), size(1), open3d::core::UInt16),
            open3d::core::Tensor(rgbd.color.data(), size(rgbd.color.channels()), open3d::core::UInt8),
            open3d::core::Tensor::Init<double>({{c.fx, 0.0, c.cx + 0.5}, {0.0, c.fy, c.cy + 0.5}, {0.0, 0.0, 1.0}}),
            open3d::core::eigen_converter::EigenMatrixToTensor(extrinsic),
            rgbd.depth_scale,
            static_cast<float>(view.max_depth_m)};
  }

  void integrate(const Frame& f) {
    const auto blocks = grid_.GetUniqueBlockCoordinates(f.depth, f.intrinsic, f.extrinsic, f.depth_scale, f.max_depth_m,
                                                        truncation_voxels_);
    if (color_) {
      grid_.Integrate(blocks, f.depth, f.color, f.intrinsic, f.extrinsic, f.depth_scale, f.max_depth_m,
                      truncation_voxels_);
    } else {
      grid_.Integrate(blocks, f.depth, f.intrinsic, f.extrinsic, f.depth_scale, f.max_depth_m, truncation_voxels_);
    }
  }

  int num_blocks() { return static_cast<int>(grid_.GetHashMap().Size()); }

  // Of each block, without colour only: distances, shares of the truncation, and weights.
  struct Block {
    BlockKey key;
    const float* distance;
    const float* weight;
  };
  std::vector<Block> blocks() {
    const auto map = grid_.GetHashMap();
    const auto keys = map.GetKeyTensor();
    const auto active = map.GetActiveIndices().To(open3d::core::Int64).ToFlatVector<std::int64_t>();
    const auto* key = keys.GetDataPtr<std::int32_t>();
    distance_ = grid_.GetAttribute("tsdf");
    weight_ = grid_.GetAttribute("weight");
    std::vector<Block> all;
    for (const std::int64_t k : active) {
      all.push_back({{key[3 * k], key[3 * k + 1], key[3 * k + 2]},
                     distance_.GetDataPtr<float>() + k * kBlockVoxels,
                     weight_.GetDataPtr<float>() + k * kBlockVoxels});
    }
    return all;
  }

 private:
  float truncation_voxels_;
  bool color_;
  open3d::t::geometry::VoxelBlockGrid grid_;
  open3d::core::Tensor distance_, weight_;
};

}  // namespace povslam
