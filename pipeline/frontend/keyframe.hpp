// A frame that is kept: its pose, its features and the landmarks they see. Arrays point into the map's slabs.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "pipeline/base/time.hpp"
#include "pipeline/frontend/orb.hpp"
#include "pipeline/geometry/rigid.hpp"

namespace povslam {

struct Covisible {
  std::int32_t keyframe = -1;  // slot
  std::int32_t weight = 0;     // landmarks seen by both
};

inline constexpr int kMaxCovisible = 24;

struct Keyframe {
  bool alive = false;
  std::int64_t id = -1;  // unique for ever
  std::int64_t frame_index = 0;
  TimeNs stamp = 0;
  Rigid3 T_world_camera;
  Matrix6d covariance = Matrix6d::Zero();  // of T_world_camera (see Rigid3), as believed when it was made
  std::int64_t parent_id = -1;             // keyframe it was tracked against; -1: the first, where the world hangs
  std::int64_t mark = -1;                  // scratch, see Landmark
  std::int32_t votes = 0;                  // scratch: shared landmarks counted

  std::span<float> x, y, sigma_px;                      // px, rectified
  std::span<float> inverse_depth, sigma_inverse_depth;  // 1/m; 0 = none
  std::span<std::uint8_t> level;
  std::span<Descriptor> descriptor;
  std::span<std::uint32_t> word;     // of the vocabulary, for recognising places
  std::span<std::int32_t> landmark;  // slot, kNone
  std::uint32_t joined = 0;          // changes with every change of `landmark`

  int num_covisible = 0;
  std::array<Covisible, kMaxCovisible> covisible{};  // heaviest first
};

}  // namespace povslam
