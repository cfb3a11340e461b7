// How far an estimated trajectory is from the true one.
//
// Poses are T_world_camera, metres; truth is interpolated at the estimate's stamps. Both worlds may differ by a rigid
// motion, taken out in two ways:
//   first fixed   T = T_truth_first * T_estimate_first^-1 on every pose (the headline: nothing is fitted);
//                 "first" is the first estimate that has truth
//   aligned       the rigid motion that fits the positions best (Umeyama 1991, without scale)
// ATE: distances of positions; RPE (Sturm et al., IROS 2012): E = (P_i^-1 P_j)^-1 (Q_i^-1 Q_j) over a fixed time.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "drivers/replay/trajectory_file.hpp"

namespace povslam::scores {

struct ScoredPose {
  TimeNs stamp = 0;
  Rigid3 T_world_truth;
  Rigid3 T_world_estimate;
  bool held = false;  // frame without an estimate: carries the last estimate before it
};

struct MatchedTrajectory {
  std::vector<ScoredPose> poses;         // by stamp
  std::size_t total_frames = 0;          // frames that could have had an estimate
  std::size_t tracked_frames = 0;        // of those, frames that have one
  std::size_t held_frames = 0;           // lost ones after the first estimate
  std::size_t frames_before_first = 0;   // frames before the first estimate: not scored
  std::size_t frames_without_truth = 0;  // an estimate (or held pose), but no truth near enough in time
};

// frames: stamps of the recording's frames, in order. Empty = not known: then every estimate is scored, nothing is
// held, and total_frames are the truth's stamps inside the estimate's span, tracked those with an estimate within
// max_gap_s. max_gap_s: longest hole in the truth that is interpolated over.
MatchedTrajectory match_trajectories(const std::vector<StampedPose>& truth, const std::vector<StampedPose>& estimate,
                                     const std::vector<TimeNs>& frames, double max_gap_s);

struct PoseErrors {
  double rmse_m = 0.0, mean_m = 0.0, median_m = 0.0, max_m = 0.0;
  double rotation_rmse_deg = 0.0;
  std::size_t poses = 0;
};

// Motions T_truth_estimate that bring the estimate's world onto the truth's. poses must not be empty.
Rigid3 fix_first_pose(std::span<const ScoredPose> poses);
std::optional<Rigid3> align_positions(std::span<const ScoredPose> poses);  // nothing for fewer than 3 poses
Rigid3 align_rotations(std::span<const ScoredPose> poses);                 // chordal mean; translation is zero

PoseErrors pose_errors(std::span<const ScoredPose> poses, const Rigid3& T_truth_estimate);  // zeros for no poses

// What a pose that never moves scores: kept at the first truth, and at the best place (the truth's mean).
struct StandstillErrors {
  double first_fixed_rmse_m = 0.0;
  double aligned_rmse_m = 0.0;
};
StandstillErrors standstill_errors(std::span<const ScoredPose> poses);

struct RelativeErrors {
  double translation_rmse_m = 0.0, rotation_rmse_deg = 0.0;
  std::size_t pairs = 0;  // zero: the run is shorter than the window
};
// Pairs (i, j), j nearest in time to i + window_s (which lies within the run) and no further from it than a tenth of
// the window.
RelativeErrors relative_errors(std::span<const ScoredPose> poses, double window_s);

}  // namespace povslam::scores
