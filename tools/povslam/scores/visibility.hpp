// What a simulated sequence's camera saw of the true objects and surfaces, from its true poses, depth images and
// instance images.
//
// Definitions, for one frame:
//   an object is visible        at least 0.05 % of the image's pixels carry its instance id
//   an empty place is visible   a fifth of the points of a 5 x 5 x 5 grid in its box were looked through: the depth
//   measured
//                               at their pixel is more than 5 cm + 3 sigma behind them
//   a surface point is visible  its surface faces the camera, and the depth measured at its pixel is its own within
//                               1 cm + 3 sigma and what half a pixel amounts to on its slant (at most 5 cm). Of a
//                               truth without normals: within 5 cm + 3 sigma, whichever way it faces
// sigma = 0.0025 z^2 [m], the simulated camera's depth noise.
#pragma once

#include <filesystem>
#include <map>
#include <vector>

#include "drivers/replay/sequence.hpp"
#include "drivers/replay/trajectory_file.hpp"
#include "pipeline/frames/image.hpp"
#include "tools/povslam/scores/ply_file.hpp"
#include "tools/povslam/scores/scene_files.hpp"

namespace povslam::scores {

struct TrueView {  // one frame, valid during the call it is handed to
  TimeNs stamp = 0;
  Rigid3 T_camera_world;
  const PinholeCamera* camera = nullptr;
  const ImageU16* depth = nullptr;
  double depth_scale = 1000.0;          // units per metre
  const ImageU16* instances = nullptr;  // null: the sequence has none
};

bool sees_place_empty(const TrueView& view, const OrientedBox& place);
// normal_world: outward, of length 1; null: not known.
bool sees_point(const TrueView& view, const Eigen::Vector3d& p_world, const Eigen::Vector3d* normal_world);
std::map<int, std::size_t> instance_pixels(const ImageU16& instances);

struct ObjectSightings {             // frames in which ...
  std::size_t object_ever = 0;       // the object was visible
  std::size_t object_after = 0;      // ... after its change (an unchanged one: ever)
  std::size_t object_before = 0;     // ... up to its change (an unchanged one: ever)
  std::size_t old_place_after = 0;   // its old place was visible as empty, after its change
  std::size_t new_place_before = 0;  // its new place was, before its change
  // Of one that moved (side_sightings.hpp): two sides that meet were seen before its change, and after it.
  bool sides_before = false, sides_after = false;
};

struct Sightings {
  bool have_instances = false;           // without instance images nothing is known of objects
  std::vector<ObjectSightings> objects;  // as SceneTruth::objects
  std::vector<std::size_t> points;       // per surface point: frames after lap 1 that see it, at most max_point_frames
};

constexpr std::size_t kMaxPointFrames = 3;

// Reads every image of the sequence once. sequence: a folder of sequence-format with camera.yaml and groundtruth.txt.
Result<Sightings> count_sightings(const std::filesystem::path& sequence, const SceneTruth& truth,
                                  const PlyMesh& surface_world);

}  // namespace povslam::scores
