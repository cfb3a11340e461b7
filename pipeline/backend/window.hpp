// What the variational EM is asked: the last m frames, the objects they look at with what is believed of each, the
// objects' landmarks, which point of which frame was matched to which landmark. POV-SLAM (Qian et al., RSS 2023),
// section III-D. Values only.
//
// World, metres, radians. Poses are camera to world (the paper's T^CW is the inverse), objects object to world.
// In the plane (dimension = 2) everything lies at z = 0 and all turns are about z: the same code with z, roll and pitch
// held, two numbers to a residual.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/geometry/rigid.hpp"
#include "pipeline/objects/class_table.hpp"
#include "pipeline/objects/object_event.hpp"

namespace povslam {

struct VemTransition {    // of odometry, between neighbouring frames; eq. 2-3
  Rigid3 T_before_after;  // maps points of the later camera into the earlier one
  double sigma_m = 0.05, sigma_rad = 0.0175;
};

struct VemPosePrior {  // on the oldest frame's T_world_camera
  Rigid3 T_world_camera;
  double sigma_m = 0.01, sigma_rad = 0.0035;
};

struct VemObject {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // T_world_object = (position, turn by yaw about z)
  double yaw = 0.0;
  Belief belief;                            // stored, before these frames
  ClassKind kind = ClassKind::semi_static;  // structure: no rigid body, no belief to change (E[v] = v_max)
  double k_inlier = 0.0, k_outlier = 3.0;   // of its class, see ObjectClass
  std::int32_t num_landmarks = 0;           // its landmarks follow those of the object before
};

struct VemLandmark {
  Eigen::Vector3d p_world = Eigen::Vector3d::Zero();   // estimate to begin with
  Eigen::Vector3d p_object = Eigen::Vector3d::Zero();  // l^O, constant; not read for structure
  Eigen::Vector3d p_prev = Eigen::Vector3d::Zero();    // world; where the map has it, eq. 5
};

struct VemMatch {
  std::int32_t frame = 0, landmark = 0;  // at most one match for each pair
  Eigen::Vector3d p_camera = Eigen::Vector3d::Zero();
  double sigma_m = 0.05;  // of the point, with depth noise
};

struct VemWindow {
  int dimension = 3;                       // 3, or 2: in the plane
  std::vector<Rigid3> poses;               // T_world_camera, oldest first; the last is the current frame
  std::vector<VemTransition> transitions;  // poses.size() - 1
  VemPosePrior prior;
  std::vector<VemObject> objects;
  std::vector<VemLandmark> landmarks;  // sorted by object
  std::vector<VemMatch> matches;       // any order
};

// Empty if the window can be solved, else what is wrong: numbers that are none, sizes that do not agree, indices
// outside, sigmas or counts that are not positive, a pair matched twice, something off the plane in the plane.
std::string fault_of(const VemWindow& window);

}  // namespace povslam
