// The part of the map around the camera: keyframes that share landmarks with the frame, their neighbours, keyframes
// that stand near and look the same way, and all landmarks those see. Where many are shared, map and frame hang
// together; what is near by place alone, or by a match or two, may be an older visit's, off by the drift since.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/frontend/map.hpp"

namespace povslam {

class LocalMap {
 public:
  explicit LocalMap(const MapOptions& options);

  // Collects around a pose and the landmarks the frame already saw (frame.landmark).
  void collect(Map& map, const Frame& frame, const Rigid3& T_world_camera);

  void forget() { keyframes_.clear(), landmarks_.clear(), num_joined_ = 0; }  // before the map changes under it

  std::span<const std::int32_t> keyframes() const { return keyframes_; }  // most shared landmarks first
  std::span<const std::int32_t> landmarks() const { return landmarks_; }  // slots, each once:
  std::span<const std::int32_t> joined() const { return landmarks().first(num_joined_); }
  std::span<const std::int32_t> remote() const { return landmarks().subspan(num_joined_); }
  std::int32_t reference() const { return keyframes_.empty() ? kNone : keyframes_.front(); }

 private:
  void find_sharing(Map& map, const Frame& frame);
  void add_sharing(Map& map, bool joined);
  void add_neighbours(Map& map);
  void add_standing_near(Map& map, const Rigid3& T_world_camera);
  void gather_landmarks(Map& map, std::size_t first, std::size_t last);

  std::size_t max_keyframes_, max_landmarks_;
  std::int64_t mark_ = -1;
  std::size_t num_joined_ = 0;  // of landmarks_, the first
  std::vector<std::int32_t> keyframes_;
  std::vector<std::int32_t> sharing_;  // most shared landmarks first
  std::vector<std::int32_t> scratch_;
  std::vector<std::int32_t> landmarks_;
};

}  // namespace povslam
