#include "pipeline/frontend/smooth_exchange.hpp"

#include <algorithm>

namespace povslam {

SmoothExchange::SmoothExchange(const PinholeCamera& camera, const FrontendOptions& options)
    : camera_(camera),
      options_(options.map),
      pose_of_keyframe_(static_cast<std::size_t>(options.map.max_keyframes), -1),
      point_of_landmark_(static_cast<std::size_t>(options.map.max_landmarks), -1),
      motion_(options.map) {}

void SmoothExchange::reserve(SmoothProblem& problem) const {
  problem.poses.reserve(static_cast<std::size_t>(options_.smooth_max_poses + options_.smooth_max_fixed_poses));
  problem.points.reserve(static_cast<std::size_t>(options_.smooth_max_points));
  problem.observations.reserve(static_cast<std::size_t>(options_.smooth_max_observations));
}

void SmoothExchange::add_pose(Map& map, std::int32_t slot, bool fixed, SmoothProblem& problem) {
  const Keyframe& kf = map.keyframe(slot);
  pose_of_keyframe_[static_cast<std::size_t>(slot)] = static_cast<std::int32_t>(problem.poses.size());
  problem.poses.push_back({kf.T_world_camera, kf.id, fixed});
}

void SmoothExchange::add_points(Map& map, std::size_t first_pose, std::size_t last_pose, SmoothProblem& problem) {
  for (std::size_t p = first_pose; p < last_pose; ++p) {
    for (const std::int32_t slot : map.keyframe(map.find_keyframe(problem.poses[p].keyframe)).landmark) {
      if (slot == kNone || point_of_landmark_[static_cast<std::size_t>(slot)] >= 0 || !map.believed(slot)) continue;
      const Landmark& point = map.landmark(slot);
      if (point.num_sightings < 2) continue;  // says nothing about poses
      if (problem.points.size() == static_cast<std::size_t>(options_.smooth_max_points)) return;
      point_of_landmark_[static_cast<std::size_t>(slot)] = static_cast<std::int32_t>(problem.points.size());
      problem.points.push_back({point.p_world, slot, point.generation});
    }
  }
}

// Keyframes outside the window that see its landmarks, those with most landmarks first.
void SmoothExchange::add_fixed_poses(Map& map, SmoothProblem& problem) {
  for (std::int32_t s = 0; s < map.keyframe_slots(); ++s) map.keyframe(s).votes = 0;
  for (const SmoothProblem::Point& p : problem.points) {
    const Landmark& point = map.landmark(p.landmark);
    for (int s = 0; s < point.num_sightings; ++s) {
      ++map.keyframe(point.sightings[static_cast<std::size_t>(s)].keyframe).votes;
    }
  }
  for (int n = 0; n < options_.smooth_max_fixed_poses; ++n) {
    std::int32_t best = kNone;
    for (std::int32_t s = 0; s < map.keyframe_slots(); ++s) {
      const Keyframe& kf = map.keyframe(s);
      if (!kf.alive || kf.votes < 3 || pose_of_keyframe_[static_cast<std::size_t>(s)] >= 0) continue;
      if (best == kNone || kf.votes > map.keyframe(best).votes) best = s;
    }
    if (best == kNone) break;
    add_pose(map, best, true, problem);
  }
}

// Patches are fitted to the first look, so the landmark is by definition what stood in that look's centre: the keyframe
// that was kept with it saw the landmark as well as a patch fits, however roughly its corner was detected.
float SmoothExchange::sigma_px(const Map& map, const Landmark& point, const LandmarkSighting& sighting) const {
  const Keyframe& kf = map.keyframe(sighting.keyframe);
  const std::size_t f = static_cast<std::size_t>(sighting.feature);
  if (!point.has_patch || point.born_keyframe != kf.id) return kf.sigma_px[f];
  return std::min(kf.sigma_px[f], look_sigma_px_ * map.level_scale(kf.level[f]));
}

void SmoothExchange::add_observations(const Map& map, SmoothProblem& problem) {
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    const Landmark& point = map.landmark(problem.points[i].landmark);
    for (int s = 0; s < point.num_sightings; ++s) {
      const LandmarkSighting& sighting = point.sightings[static_cast<std::size_t>(s)];
      const std::int32_t pose = pose_of_keyframe_[static_cast<std::size_t>(sighting.keyframe)];
      if (pose < 0) continue;
      if (problem.observations.size() == static_cast<std::size_t>(options_.smooth_max_observations)) return;
      const Keyframe& kf = map.keyframe(sighting.keyframe);
      const std::size_t f = static_cast<std::size_t>(sighting.feature);
      SmoothProblem::Observation& o = problem.observations.emplace_back();
      o.pose = pose;
      o.point = static_cast<std::int32_t>(i);
      o.u_px = kf.x[f];
      o.v_px = kf.y[f];
      o.inverse_depth_per_m = kf.inverse_depth[f];
      o.sigma_px = sigma_px(map, point, sighting);
      o.sigma_inverse_depth_per_m = kf.sigma_inverse_depth[f];
    }
  }
}

bool SmoothExchange::cut(Map& map, std::int32_t slot, std::int64_t frame_index, double look_sigma_px,
                         SmoothProblem& problem) {
  look_sigma_px_ = static_cast<float>(look_sigma_px);
  problem.clear();
  problem.fx = camera_.fx, problem.fy = camera_.fy, problem.cx = camera_.cx, problem.cy = camera_.cy;
  problem.asked_at_frame = frame_index;
  const Keyframe& kf = map.keyframe(slot);
  if (kf.num_covisible == 0) return false;
  std::fill(pose_of_keyframe_.begin(), pose_of_keyframe_.end(), -1);
  std::fill(point_of_landmark_.begin(), point_of_landmark_.end(), -1);
  add_pose(map, slot, kf.parent_id < 0, problem);  // the first keyframe of all is where the world hangs
  for (int c = 0; c < kf.num_covisible && static_cast<int>(problem.poses.size()) < options_.smooth_max_poses; ++c) {
    const std::int32_t neighbour = kf.covisible[static_cast<std::size_t>(c)].keyframe;
    add_pose(map, neighbour, map.keyframe(neighbour).parent_id < 0, problem);
  }
  add_points(map, 0, problem.poses.size(), problem);
  add_fixed_poses(map, problem);
  const bool anchored = std::any_of(problem.poses.begin(), problem.poses.end(), [](const auto& p) { return p.fixed; });
  if (!anchored) {  // nothing outside holds the window: its oldest keyframe does
    std::min_element(problem.poses.begin(), problem.poses.end(), [](const auto& a, const auto& b) {
      return a.keyframe < b.keyframe;
    })->fixed = true;
  }
  add_observations(map, problem);
  return !problem.observations.empty();
}

void SmoothExchange::move_keyframes(Map& map, const SmoothProblem& problem) {
  motion_.start();
  std::int64_t newest = -1;
  for (const SmoothProblem::Pose& pose : problem.poses) {
    newest = std::max(newest, pose.keyframe);
    const std::int32_t slot = map.find_keyframe(pose.keyframe);
    if (slot == kNone || pose.fixed) continue;
    motion_.move(map, slot, pose.T_world_camera * map.keyframe(slot).T_world_camera.inverse());
  }
  motion_.carry_newer(map, newest + 1);
}

// A sighting that does not fit is forgotten; a landmark without any left goes with it.
void SmoothExchange::drop_outliers(Map& map, const SmoothProblem& problem) {
  for (const SmoothProblem::Observation& o : problem.observations) {
    if (!o.outlier) continue;
    const SmoothProblem::Point& p = problem.points[static_cast<std::size_t>(o.point)];
    const std::int32_t kf = map.find_keyframe(problem.poses[static_cast<std::size_t>(o.pose)].keyframe);
    const Landmark& point = map.landmark(p.landmark);
    if (kf == kNone || !point.alive || point.generation != p.generation) continue;
    map.remove_sighting(p.landmark, kf);
  }
}

Rigid3 SmoothExchange::apply(Map& map, const SmoothProblem& problem, std::int64_t follow_id) {
  if (!problem.converged) return Rigid3{};
  move_keyframes(map, problem);
  const std::int64_t mark = map.new_mark();
  for (const SmoothProblem::Point& p : problem.points) {
    Landmark& point = map.landmark(p.landmark);
    if (!point.alive || point.generation != p.generation) continue;
    point.p_world = p.p_world;
    point.mark = mark;
  }
  drop_outliers(map, problem);
  motion_.carry_landmarks(map, mark);
  return motion_.of(map, follow_id);
}

}  // namespace povslam
