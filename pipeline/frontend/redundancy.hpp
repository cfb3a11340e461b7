// What the map could do without: keyframes that show what others show, landmarks that are seldom found. And the rule
// by which something goes when there is no more room: the least useful of a sample that walks through the map in turn,
// so that a full map gets thinner everywhere and a frame never waits for a search through all of it.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/frontend/map.hpp"
#include "pipeline/geometry/camera.hpp"

namespace povslam {

// How far the image moves from one view to the other, in image widths: by the turn, and by the parallax of a point at
// that inverse depth [1/m].
double image_shift(const PinholeCamera& camera, const Rigid3& T_world_a, const Rigid3& T_world_b,
                   double inverse_depth_per_m);

struct KeyframeUse {
  int seen = 0;  // landmarks it sees
  int own = 0;   // of those: fewer than three others see them at least as closely
};
KeyframeUse use_of(const Map& map, std::int32_t keyframe);

int landmarks_seen(const Keyframe& keyframe);

// The keyframe with the fewest landmarks of its own, never one where the world hangs.
class KeyframeRoom {
 public:
  // Makes room for one keyframe if there is none.
  void make(Map& map, int max_keyframes);

 private:
  std::int32_t cursor_ = 0;
};

// The landmarks that would be missed least: found in the smallest share of the frames that should have shown them.
class LandmarkRoom {
 public:
  explicit LandmarkRoom(int max_wanted);
  // Makes room for that many landmarks if there is none.
  void make(Map& map, int max_landmarks, int wanted);

 private:
  struct Candidate {
    float share = 0.0F;
    std::int32_t slot = kNone;
  };
  std::vector<Candidate> sample_;
  std::int32_t cursor_ = 0;
};

}  // namespace povslam
