#include <algorithm>

#include "tools/povslam/scores/trajectory_score.hpp"

namespace povslam::scores {
namespace {

constexpr TimeNs kSameStamp = 2 * kNsPerMs;  // stamps pass through text of few digits

void score(const std::vector<StampedPose>& truth, TimeNs stamp, const Rigid3& T_world_estimate, bool held,
           double max_gap_s, MatchedTrajectory& matched) {
  const std::optional<Rigid3> T_world_truth = pose_at(truth, stamp, max_gap_s);
  if (T_world_truth) {
    matched.poses.push_back({stamp, *T_world_truth, T_world_estimate, held});
  } else {
    ++matched.frames_without_truth;
  }
}

bool has_estimate_near(const std::vector<StampedPose>& estimate, TimeNs stamp, TimeNs reach) {
  const auto near = std::lower_bound(estimate.begin(), estimate.end(), stamp - reach,
                                     [](const StampedPose& pose, TimeNs value) { return pose.stamp < value; });
  return near != estimate.end() && near->stamp <= stamp + reach;
}

void match_every_estimate(const std::vector<StampedPose>& truth, const std::vector<StampedPose>& estimate,
                          double max_gap_s, MatchedTrajectory& matched) {
  for (const StampedPose& pose : estimate) score(truth, pose.stamp, pose.T_world_sensor, false, max_gap_s, matched);
  if (estimate.empty()) return;
  for (const StampedPose& pose : truth) {
    if (pose.stamp < estimate.front().stamp || pose.stamp > estimate.back().stamp) continue;
    ++matched.total_frames;
    if (has_estimate_near(estimate, pose.stamp, from_seconds(max_gap_s))) ++matched.tracked_frames;
  }
}

}  // namespace

MatchedTrajectory match_trajectories(const std::vector<StampedPose>& truth, const std::vector<StampedPose>& estimate,
                                     const std::vector<TimeNs>& frames, double max_gap_s) {
  MatchedTrajectory matched;
  if (frames.empty()) {
    match_every_estimate(truth, estimate, max_gap_s, matched);
    return matched;
  }
  matched.total_frames = frames.size();
  std::size_t next = 0;               // first estimate not yet passed
  const StampedPose* last = nullptr;  // latest estimate published up to this frame
  for (const TimeNs frame : frames) {
    bool tracked = false;
    for (; next < estimate.size() && estimate[next].stamp <= frame + kSameStamp; ++next) {
      last = &estimate[next];
      tracked = last->stamp >= frame - kSameStamp;
    }
    if (last == nullptr) {
      ++matched.frames_before_first;
      continue;
    }
    ++(tracked ? matched.tracked_frames : matched.held_frames);
    score(truth, tracked ? last->stamp : frame, last->T_world_sensor, !tracked, max_gap_s, matched);
  }
  return matched;
}

}  // namespace povslam::scores
