// What of a tracked frame goes into the window.
#include <algorithm>
#include <cmath>

#include "pipeline/vem_exchange.hpp"

namespace povslam {

namespace {
constexpr int kMinMissing = 6;      // landmarks of an object through whose places the camera sees…
constexpr double kMoreMissing = 2;  // …so many times those that are there, and it is looked for elsewhere
constexpr double kMarginM = 0.1, kMarginSigmas = 3.0;  // of depth: clearly behind, clearly before
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

void VemExchange::look(const Map& map, const LocalMap& around, const RgbdFrame& input, const Frame& frame,
                       const Rigid3& T_odom_camera) {
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
  }
  find_missing(map, around, input, frame);
  look_elsewhere(map, frame, next);
  share_out(map, next);
  frames_.push_back(std::move(next));
  due_ = true;
}

// Landmarks of known objects that lie in the image and show in no feature, where the camera sees through their places.
void VemExchange::find_missing(const Map& map, const LocalMap& around, const RgbdFrame& input, const Frame& frame) {
  for (auto& [id, known] : known_) known.standing = known.missing = 0;
  wanted_.clear();
  const Eigen::Vector3d p_world_camera = frame.T_camera_world.inverse().translation;
  for (const std::int32_t slot : around.landmarks()) {
    const Landmark& point = map.landmark(slot);
    const auto entry = point.alive && point.owner >= 0 ? known_.find(point.owner) : known_.end();
    if (entry == known_.end()) continue;
    Known& known = entry->second;
    if (found_at_[static_cast<std::size_t>(slot)] == frame_index_) {
      ++known.standing;
      continue;
    }
    const Eigen::Vector3d p = frame.T_camera_world * point.p_world;
    const Eigen::Vector3d toward = p_world_camera - point.p_world;
    if (p.z() < 0.1 || toward.dot(point.toward_camera) < kMaxViewChangeCos * toward.norm()) continue;
    const auto pixel = camera_.project(p);
    if (!pixel || !camera_.contains(*pixel)) continue;
    const std::uint16_t reading =
        input.depth.at(static_cast<int>(std::lround(pixel->x())), static_cast<int>(std::lround(pixel->y())));
    const double depth_m = static_cast<double>(reading) / static_cast<double>(input.depth_scale);
    const double margin_m = kMarginM + kMarginSigmas * depth_noise_ * depth_m * depth_m;
    if (reading == 0 || depth_m < p.z() - margin_m) continue;
    ++(depth_m > p.z() + margin_m ? known.missing : known.standing);
    if (wanted_.size() < wanted_.capacity()) wanted_.push_back(slot);
  }
}

// A thing that is not where it was may be near; if so, its look tells how it, or the camera, has moved.
void VemExchange::look_elsewhere(const Map& map, const Frame& frame, WindowFrame& into) {
  std::erase_if(wanted_, [&](std::int32_t slot) {
    const Known& known = known_.find(map.landmark(slot).owner)->second;
    if (known.doubted) return false;  // tracking does not look for it: whether it is back is to be seen here
    return known.missing < kMinMissing || known.missing < kMoreMissing * known.standing;
  });
  elsewhere_.clear();
  for (int i = 0; i < frame.size(); ++i) {
    const std::int32_t slot = frame.misfit[static_cast<std::size_t>(i)];
    if (slot != kNone) note_elsewhere(map, frame, i, slot, into);
  }
  if (!wanted_.empty()) {
    search_.match_wide(map, wanted_, frame, frame.T_camera_world, options_.reach_m, matcher_);
    for (int i = 0; i < frame.size(); ++i) {
      if (matcher_.tag_of(i) != kNone) note_elsewhere(map, frame, i, matcher_.tag_of(i), into);
    }
  }
  keep_agreeing(map, frame, into);
}

void VemExchange::note_elsewhere(const Map& map, const Frame& frame, int feature, std::int32_t slot,
                                 const WindowFrame& into) {
  const Landmark& point = map.landmark(slot);
  if (!frame.has_depth(feature) || point.owner < 0) return;
  elsewhere_.push_back(
      {point.owner, slot, feature, into.T_world_camera * frame.point_camera(feature, camera_) - point.p_world});
}

// What looks alike by chance lies anywhere; the points of one thing moved together.
void VemExchange::keep_agreeing(const Map& map, const Frame& frame, WindowFrame& into) {
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
