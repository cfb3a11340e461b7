// What of a tracked frame goes into the window.
#include <algorithm>
#include <cmath>

#include "pipeline/vem_exchange.hpp"

namespace povslam {

namespace {
constexpr int kMinExpected = 10;        // landmarks of an object that lie in the image…
constexpr double kMinFoundShare = 0.2;  // …of which so many are found, or it is looked for elsewhere
constexpr double kMaxViewChangeCos = 0.45;
constexpr double kAgreeM = 0.15;  // points of one thing that was shifted, and turned a little, moved alike within this…
constexpr int kMinAgreeing = 6;  // …and are so many
}  // namespace

void VemExchange::see(const Map& map, const Frame& frame, int feature, std::int32_t landmark, WindowFrame& into) {
  if (landmark == kNone || !frame.has_depth(feature)) return;
  if (std::exchange(found_at_[static_cast<std::size_t>(landmark)], frame_index_) == frame_index_) return;
  const auto k = static_cast<std::size_t>(feature);
  Seen seen;
  seen.landmark = landmark;
  seen.generation = map.landmark(landmark).generation;
  seen.p_camera = frame.point_camera(feature, camera_);
  const double z = seen.p_camera.z(), sigma_z = z * z * static_cast<double>(frame.sigma_inverse_depth[k]);
  seen.sigma_m = std::sqrt(match_variance_ + sigma_z * sigma_z);
  into.seen.push_back(seen);
}

void VemExchange::look(const Map& map, const LocalMap& around, const Frame& frame, const Rigid3& T_odom_camera) {
  if (options_.every_frames == 0) return;
  if (last_taken_ >= 0 && frame.index - last_taken_ < options_.every_frames) return;
  last_taken_ = frame.index;
  frame_index_ = frame.index;
  WindowFrame next;
  if (std::ssize(frames_) == options_.frames) {
    next = std::move(frames_.front());
    frames_.erase(frames_.begin());
  } else if (!spare_.empty()) {
    next = std::move(spare_.back());
    spare_.pop_back();
  }
  next.seen.clear();
  next.T_world_camera = frame.T_camera_world.inverse();
  next.T_odom_camera = T_odom_camera;
  for (int i = 0; i < frame.size(); ++i) {
    see(map, frame, i, frame.landmark[static_cast<std::size_t>(i)], next);
    see(map, frame, i, frame.misfit[static_cast<std::size_t>(i)], next);
  }
  look_elsewhere(map, around, frame, next);
  share_out(map, next);
  frames_.push_back(std::move(next));
  due_ = true;
}

// Objects whose landmarks should be in the image and are not: the thing moved, or the camera is elsewhere.
void VemExchange::look_elsewhere(const Map& map, const LocalMap& around, const Frame& frame, WindowFrame& into) {
  for (auto& [id, known] : known_) known.expected = known.found = 0;
  wanted_.clear();
  const Rigid3& T_world_camera = into.T_world_camera;
  for (const std::int32_t slot : around.landmarks()) {
    const Landmark& point = map.landmark(slot);
    const auto entry = point.alive && point.owner >= 0 ? known_.find(point.owner) : known_.end();
    if (entry == known_.end()) continue;
    const Eigen::Vector3d p = frame.T_camera_world * point.p_world;
    if (p.z() < 0.1) continue;
    const Eigen::Vector2d pixel(camera_.fx * p.x() / p.z() + camera_.cx, camera_.fy * p.y() / p.z() + camera_.cy);
    const Eigen::Vector3d toward = T_world_camera.translation - point.p_world;
    if (!camera_.contains(pixel) || toward.dot(point.toward_camera) < kMaxViewChangeCos * toward.norm()) continue;
    ++entry->second.expected;
    const bool found = found_at_[static_cast<std::size_t>(slot)] == frame_index_;
    entry->second.found += found ? 1 : 0;
    if (!found && wanted_.size() < wanted_.capacity()) wanted_.push_back(slot);
  }
  std::erase_if(wanted_, [&](std::int32_t slot) {
    const Known& known = known_.find(map.landmark(slot).owner)->second;
    return known.expected < kMinExpected || known.found > kMinFoundShare * known.expected;
  });
  if (wanted_.empty()) return;
  search_.match_wide(map, wanted_, frame, frame.T_camera_world, options_.reach_m, matcher_);
  keep_agreeing(map, frame, into);
}

// What looks alike by chance lies anywhere; the points of one thing moved together.
void VemExchange::keep_agreeing(const Map& map, const Frame& frame, WindowFrame& into) {
  elsewhere_.clear();
  for (int i = 0; i < frame.size(); ++i) {
    const std::int32_t slot = matcher_.tag_of(i);
    if (slot == kNone || !frame.has_depth(i)) continue;
    const Landmark& point = map.landmark(slot);
    elsewhere_.push_back({point.owner, slot, i, into.T_world_camera * frame.point_camera(i, camera_) - point.p_world});
  }
  for (const Elsewhere& one : elsewhere_) {
    const auto agrees = [&](const Elsewhere& other) {
      return other.object == one.object && (other.moved - one.moved).squaredNorm() < kAgreeM * kAgreeM;
    };
    if (std::ranges::count_if(elsewhere_, agrees) >= kMinAgreeing) see(map, frame, one.feature, one.slot, into);
  }
}

// Where a frame has more matches than there is room for, each object keeps as many as the others, or all it has: small
// things say where the camera is as well as large ones.
void VemExchange::share_out(const Map& map, WindowFrame& frame) {
  const auto room = static_cast<std::size_t>(options_.max_matches);
  if (frame.seen.size() <= room) return;
  std::unordered_map<std::int64_t, int> count, kept;
  for (const Seen& seen : frame.seen) ++count[map.landmark(seen.landmark).owner];
  int low = 0, high = options_.max_matches;
  while (high - low > 1) {  // the largest share that fits
    const int share = (low + high) / 2;
    std::size_t sum = 0;
    for (const auto& [owner, n] : count) sum += static_cast<std::size_t>(std::min(n, share));
    (sum <= room ? low : high) = share;
  }
  std::erase_if(frame.seen, [&](const Seen& seen) {
    const std::int64_t owner = map.landmark(seen.landmark).owner;
    const std::int64_t n = count[owner], k = kept[owner]++;
    return n > low && (k + 1) * low / n == k * low / n;
  });
}

}  // namespace povslam
