// From the frames kept to the window that is solved.
#include <algorithm>

#include "pipeline/vem_exchange.hpp"

namespace povslam {

namespace {
constexpr int kMinOfObject = 6;  // matches in the window, or the object is left out
}  // namespace

// Nothing to be asked without an object that may have moved.
bool VemExchange::fill(const Map& map) {
  problem_.window = {};
  problem_.object.clear();
  problem_.result = {};
  problem_.asked_at_frame = frame_index_;
  if (frames_.empty()) return false;
  add_motion();
  add_objects(map);
  add_matches(map);
  for (const Entry& entry : entries_) index_of_landmark_[static_cast<std::size_t>(entry.slot)] = kNone;
  return std::ranges::any_of(problem_.object, [](std::int64_t id) { return id >= 0; });
}

// Odometry alone says how the frames lie to one another: the map may have been corrected since they were tracked.
void VemExchange::add_motion() {
  VemWindow& window = problem_.window;
  const Rigid3 T_world_odom = frames_.back().T_world_camera * frames_.back().T_odom_camera.inverse();
  for (const WindowFrame& frame : frames_) window.poses.push_back(T_world_odom * frame.T_odom_camera);
  for (std::size_t t = 1; t < frames_.size(); ++t) {
    window.transitions.push_back({frames_[t - 1].T_odom_camera.inverse() * frames_[t].T_odom_camera,
                                  options_.vo_sigma_m, options_.vo_sigma_rad});
  }
  window.prior = {window.poses.front(), options_.prior_sigma_m, options_.prior_sigma_rad};
}

// Landmarks by object; those of nobody, and of what is not known yet, are structure's.
void VemExchange::add_objects(const Map& map) {
  entries_.clear();
  std::unordered_map<std::int64_t, int> matches;
  for (const WindowFrame& frame : frames_) {
    for (const Seen& seen : frame.seen) {
      const Landmark& point = map.landmark(seen.landmark);
      if (!point.alive || point.generation != seen.generation) continue;
      const std::int64_t object = known_.contains(point.owner) ? point.owner : -1;
      ++matches[object];
      if (index_of_landmark_[static_cast<std::size_t>(seen.landmark)] != kNone) continue;
      index_of_landmark_[static_cast<std::size_t>(seen.landmark)] = 0;
      entries_.push_back({object, seen.landmark});
    }
  }
  for (const Entry& entry : entries_) index_of_landmark_[static_cast<std::size_t>(entry.slot)] = kNone;
  std::erase_if(entries_, [&](const Entry& entry) { return matches[entry.object] < kMinOfObject; });
  std::ranges::sort(entries_, {}, [](const Entry& entry) { return std::pair(entry.object, entry.slot); });
  VemWindow& window = problem_.window;
  for (const Entry& entry : entries_) {
    if (problem_.object.empty() || problem_.object.back() != entry.object) {
      problem_.object.push_back(entry.object);
      window.objects.push_back(as_object(entry.object));
    }
    VemObject& object = window.objects.back();
    ++object.num_landmarks;
    const Eigen::Vector3d& p_world = map.landmark(entry.slot).p_world;
    const Rigid3 T_world_object{Eigen::Quaterniond(Eigen::AngleAxisd(object.yaw, Eigen::Vector3d::UnitZ())),
                                object.position};
    window.landmarks.push_back({p_world, T_world_object.inverse() * p_world, p_world});
    index_of_landmark_[static_cast<std::size_t>(entry.slot)] = static_cast<std::int32_t>(window.landmarks.size()) - 1;
  }
}

VemObject VemExchange::as_object(std::int64_t id) const {
  VemObject object;
  const auto known = known_.find(id);
  if (known == known_.end()) {
    object.kind = ClassKind::structure;
    return object;
  }
  const ObjectBelief& belief = known->second.belief;
  object.position = belief.place.position;
  object.yaw = belief.place.yaw;
  object.belief = belief.belief;
  object.kind = belief.kind;
  object.k_inlier = belief.k_inlier;
  object.k_outlier = belief.k_outlier;
  return object;
}

void VemExchange::add_matches(const Map& map) {
  for (std::size_t t = 0; t < frames_.size(); ++t) {
    for (const Seen& seen : frames_[t].seen) {
      const std::int32_t index = index_of_landmark_[static_cast<std::size_t>(seen.landmark)];
      const bool replaced = map.landmark(seen.landmark).generation != seen.generation;
      if (index == kNone || replaced) continue;
      problem_.window.matches.push_back({static_cast<std::int32_t>(t), index, seen.p_camera, seen.sigma_m});
    }
  }
}

}  // namespace povslam
