// The sparse map as plain values: what is written to disk, piece by piece, and read back whole.
// Everything hangs on keyframes: a landmark's place is told in the axes of its anchor, so rows of different age fit
// together even when a loop closure moved the keyframes in between.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/base/time.hpp"
#include "pipeline/frontend/orb.hpp"
#include "pipeline/frontend/patch.hpp"
#include "pipeline/geometry/rigid.hpp"

namespace povslam {

// What a keyframe saw. Never changes once made. All vectors are of one length, by feature.
struct KeyframeFeatures {
  std::int64_t keyframe = -1;  // id, unique for ever within one map
  TimeNs stamp = 0;
  std::vector<float> x, y, sigma_px;                      // px, rectified
  std::vector<float> inverse_depth, sigma_inverse_depth;  // 1/m; 0 = none
  std::vector<std::uint8_t> level;
  std::vector<Descriptor> descriptor;
  std::vector<std::uint32_t> word;  // of the vocabulary named in MapMeta; empty: not known
};

// Where a keyframe stands and what its features are. Changes as the map is corrected.
struct KeyframeRow {
  std::int64_t keyframe = -1;
  std::int64_t parent = -1;  // keyframe it was tracked against; -1: where the world hangs
  Rigid3 T_world_camera;
  Matrix6d covariance = Matrix6d::Zero();  // of T_world_camera (see Rigid3)
  std::vector<std::int64_t> landmark;      // by feature: id of the landmark it sees, -1; one that is unknown is none
};

struct LandmarkRow {
  std::int64_t landmark = -1;                          // id, unique for ever within one map
  std::int64_t anchor = -1;                            // keyframe it hangs on and that sees it
  Eigen::Vector3d p_anchor = Eigen::Vector3d::Zero();  // m, in the anchor's camera axes
  std::int64_t born_keyframe = -1;
  std::int32_t visible = 0, found = 0;  // see Landmark
  bool has_patch = false;
  Eigen::Vector3f tangent_x_anchor = Eigen::Vector3f::Zero();  // see Landmark, in the anchor's axes
  Eigen::Vector3f tangent_y_anchor = Eigen::Vector3f::Zero();
};

// Its look at first sight. Never changes once made.
struct LandmarkLook {
  std::int64_t landmark = -1;
  Patch patch;
};

struct MapMeta {
  std::int64_t next_keyframe = 0;  // ids not used yet
  std::int64_t next_landmark = 0;
  std::uint32_t map_version = 0;
  std::uint64_t vocabulary = 0;                   // fingerprint of the one the words are of; 0: none
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  // px, of the camera all features are rectified to; 0: not known
  double level_scale = 0.0;                       // size ratio of neighbouring pyramid levels; 0: not known
};

// The whole map, or what became of it since the last change: rows replace older ones of the same id. A reader applies
// changes in order and gets the map.
struct MapChange {
  MapMeta meta;
  std::vector<KeyframeFeatures> features;
  std::vector<KeyframeRow> keyframes;
  std::vector<LandmarkRow> landmarks;
  std::vector<LandmarkLook> looks;
  std::vector<std::int64_t> removed_keyframes;  // with their features
  std::vector<std::int64_t> removed_landmarks;  // with their looks

  bool empty() const {
    return features.empty() && keyframes.empty() && landmarks.empty() && looks.empty() && removed_keyframes.empty() &&
           removed_landmarks.empty();
  }
  void clear() { *this = MapChange{}; }
};
using MapContent = MapChange;  // nothing removed, each id once

}  // namespace povslam
