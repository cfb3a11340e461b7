// Moves keyframes, and everything that hangs on them: keyframes made meanwhile, landmarks.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/frontend/map.hpp"

namespace povslam {

class MapMotion {
 public:
  explicit MapMotion(const MapOptions& options) : motions_(static_cast<std::size_t>(options.max_keyframes)) {}

  void start();
  // T_new_old: in the world. Later of one keyframe: none.
  void move(Map& map, std::int32_t keyframe, const Rigid3& T_new_old);
  // Keyframes with ids from `first_id` on move along with what they were tracked against.
  void carry_newer(Map& map, std::int64_t first_id);
  // Landmarks move along with their anchors, but for those whose mark is `placed`.
  void carry_landmarks(Map& map, std::int64_t placed);
  // How the keyframe was moved; identity: it was not.
  Rigid3 of(const Map& map, std::int64_t keyframe_id) const;

 private:
  struct Motion {
    bool moved = false;
    Rigid3 T_new_old;
  };
  std::vector<Motion> motions_;  // by keyframe slot
};

}  // namespace povslam
