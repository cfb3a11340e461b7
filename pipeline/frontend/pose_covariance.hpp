// How far a tracked pose may be off the truth: what the frame's own residuals allow, on top of how well the keyframes
// that hold its landmarks are known. Covariances as Rigid3 states them.
#pragma once

#include "pipeline/frontend/frame.hpp"
#include "pipeline/frontend/map.hpp"
#include "pipeline/frontend/solve_pose.hpp"

namespace povslam {

// Of T_world_camera relative to the landmarks: the inverse of the final normal equations. Residuals of neighbouring
// landmarks share errors (calibration, patches, depth), so no more than a few dozen count as independent.
Matrix6d covariance_to_landmarks(const PoseSolution& solution);

// Mean covariance of the keyframes the frame's landmarks hang on, carried to the camera; a keyframe counts as often as
// it holds a landmark. Neighbouring keyframes err together, so the mean, not the product, is what is known.
Matrix6d covariance_of_anchors(Map& map, const Frame& frame, const Rigid3& T_world_camera);

// A pose error at p_from seen at p_to: the turn swings the place around.
Matrix6d carry_covariance(const Matrix6d& covariance, const Eigen::Vector3d& p_from, const Eigen::Vector3d& p_to);

}  // namespace povslam
