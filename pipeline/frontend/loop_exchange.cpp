#include "pipeline/frontend/loop_exchange.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace povslam {

namespace {

// How well tracking knows the way between two keyframes that share landmarks, one standard deviation: a base, and a
// share of the way. Drift is what these add up to, and it adds up: errors of neighbours are alike (a focal length that
// is off bends every turn the same way), so the shares are those of a bad day, that a loop that was verified can bend
// the way and not the other way round. Heading is hardly lost where nothing turns: straight ways that could be bent at
// each keyframe would take up what the turns made, and swing out.
constexpr double kBaseM = 0.01, kBaseRad = 0.0005, kShareOfWay = 0.05;
constexpr double kWellShared = 50.0;  // landmarks
constexpr int kEdgesPerKeyframe = 4;
// Of a place recognised, by its fitting landmarks.
constexpr double kLoopM = 0.02, kLoopRad = 0.004;
// Between parts of the map that share nothing any more.
constexpr double kLooseM = 0.1, kLooseRad = 0.05;

LoopProblem::Edge edge_between(const LoopProblem& problem, std::int32_t from, std::int32_t to) {
  LoopProblem::Edge edge;
  edge.from = from;
  edge.to = to;
  edge.T_from_to = problem.poses[static_cast<std::size_t>(from)].T_world_camera.inverse() *
                   problem.poses[static_cast<std::size_t>(to)].T_world_camera;
  return edge;
}

LoopProblem::Edge tracked_edge(const LoopProblem& problem, std::int32_t from, std::int32_t to, std::int32_t shared) {
  LoopProblem::Edge edge = edge_between(problem, from, to);
  const double doubt = std::clamp(std::sqrt(kWellShared / std::max(1, shared)), 0.5, 2.0);
  edge.sigma_m = doubt * (kBaseM + kShareOfWay * edge.T_from_to.translation.norm());
  edge.sigma_rad = doubt * (kBaseRad + kShareOfWay * rotation_angle_rad(edge.T_from_to));
  return edge;
}

struct Parts {  // union-find
  explicit Parts(std::size_t n) : parent(n) { std::iota(parent.begin(), parent.end(), std::int32_t{0}); }
  std::int32_t of(std::int32_t i) {
    std::int32_t& up = parent[static_cast<std::size_t>(i)];
    return up == i ? i : up = of(up);
  }
  bool join(std::int32_t a, std::int32_t b) {
    a = of(a), b = of(b);
    parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    return a != b;
  }
  std::vector<std::int32_t> parent;
};

}  // namespace

LoopExchange::LoopExchange(const MapOptions& options)
    : pose_of_keyframe_(static_cast<std::size_t>(options.max_keyframes), -1), motion_(options) {}

bool LoopExchange::cut(const Map& map, const LoopFound& found, std::int64_t frame_index, LoopProblem& problem) {
  problem.clear();
  problem.asked_at_frame = frame_index;
  const std::int32_t now = map.find_keyframe(found.now), then = map.find_keyframe(found.then);
  if (now == kNone || then == kNone || now == then) return false;
  std::vector<std::int32_t> slots;
  for (std::int32_t s = 0; s < map.keyframe_slots(); ++s) {
    if (map.keyframe(s).alive) slots.push_back(s);
  }
  std::sort(slots.begin(), slots.end(), [&](auto a, auto b) { return map.keyframe(a).id < map.keyframe(b).id; });
  for (const std::int32_t s : slots) {
    const Keyframe& kf = map.keyframe(s);
    pose_of_keyframe_[static_cast<std::size_t>(s)] = static_cast<std::int32_t>(problem.poses.size());
    problem.poses.push_back({kf.T_world_camera, kf.id, kf.parent_id < 0});
  }
  const bool rooted = std::ranges::any_of(problem.poses, &LoopProblem::Pose::fixed);
  if (!rooted) problem.poses.front().fixed = true;
  add_edges(map, problem);
  join_parts(problem);
  LoopProblem::Edge& loop = problem.edges.emplace_back();
  loop.from = pose_of_keyframe_[static_cast<std::size_t>(then)];
  loop.to = pose_of_keyframe_[static_cast<std::size_t>(now)];
  loop.T_from_to = found.T_then_now;
  const double doubt = std::clamp(std::sqrt(kWellShared / std::max(1, found.num_inliers)), 0.5, 2.0);
  loop.sigma_m = doubt * kLoopM;
  loop.sigma_rad = doubt * kLoopRad;
  loop.loop = true;
  T_world_camera_asked_.clear();
  for (const LoopProblem::Pose& pose : problem.poses) T_world_camera_asked_.push_back(pose.T_world_camera);
  return true;
}

void LoopExchange::add_edges(const Map& map, LoopProblem& problem) const {
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    const std::int32_t self = map.find_keyframe(problem.poses[i].keyframe);
    const Keyframe& kf = map.keyframe(self);
    const auto to = static_cast<std::int32_t>(i);
    for (int c = 0; c < std::min(kf.num_covisible, kEdgesPerKeyframe); ++c) {
      const Covisible& other = kf.covisible[static_cast<std::size_t>(c)];
      const std::int32_t from = pose_of_keyframe_[static_cast<std::size_t>(other.keyframe)];
      if (from < to) problem.edges.push_back(tracked_edge(problem, from, to, other.weight));
    }
  }
}

// Every pose must hang on the rest somehow: a part that shares landmarks with no other hangs on the keyframe made just
// before its first.
void LoopExchange::join_parts(LoopProblem& problem) {
  Parts parts(problem.poses.size());
  for (const LoopProblem::Edge& edge : problem.edges) parts.join(edge.from, edge.to);
  for (std::int32_t i = 1; i < static_cast<std::int32_t>(problem.poses.size()); ++i) {
    if (parts.of(i) != i) continue;  // not the first of a part
    parts.join(i - 1, i);
    LoopProblem::Edge loose = edge_between(problem, i - 1, i);
    loose.sigma_m = kLooseM;
    loose.sigma_rad = kLooseRad;
    problem.edges.push_back(loose);
  }
}

std::optional<Rigid3> LoopExchange::apply(Map& map, const LoopProblem& problem, std::int64_t follow_id) {
  if (!problem.converged) return std::nullopt;
  motion_.start();
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    const std::int32_t slot = map.find_keyframe(problem.poses[i].keyframe);
    if (slot == kNone) continue;
    motion_.move(map, slot, problem.poses[i].T_world_camera * T_world_camera_asked_[i].inverse());
  }
  motion_.carry_newer(map, problem.poses.back().keyframe + 1);
  motion_.carry_landmarks(map, map.new_mark());
  return motion_.of(map, follow_id);
}

}  // namespace povslam
