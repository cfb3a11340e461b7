// The part of the map around the camera: keyframes that share landmarks with the frame, their neighbours, keyframes
// that stand near and look the same way, and all landmarks those see.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/frontend/map.hpp"

namespace povslam {

struct LocalLandmark {
  std::int32_t slot = kNone;
  bool remote = false;  // seen only by keyframes that share no landmark with the frame: an older visit, maybe
};

class LocalMap {
 public:
  explicit LocalMap(const MapOptions& options);

  // Collects around a pose and the landmarks the frame already saw (frame.landmark).
  void collect(Map& map, const Frame& frame, const Rigid3& T_world_camera);

  void forget() { keyframes_.clear(), landmarks_.clear(); }  // before the map changes under it

  std::span<const std::int32_t> keyframes() const { return keyframes_; }  // most shared landmarks first
  std::span<const LocalLandmark> landmarks() const { return landmarks_; }
  std::int32_t reference() const { return keyframes_.empty() ? kNone : keyframes_.front(); }

 private:
  void add_sharing(Map& map, const Frame& frame);
  void add_neighbours(Map& map);
  void add_standing_near(Map& map, const Rigid3& T_world_camera);
  void gather_landmarks(Map& map);

  std::size_t max_keyframes_, max_landmarks_;
  std::int64_t mark_ = -1;
  std::size_t num_sharing_ = 0;  // the first of keyframes_: these or their neighbours share landmarks
  std::vector<std::int32_t> keyframes_;
  std::vector<std::int32_t> scratch_;
  std::vector<LocalLandmark> landmarks_;
};

}  // namespace povslam
