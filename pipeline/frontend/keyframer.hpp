// When a frame is kept, what the map learns from it, and what the map forgets.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/frontend/map.hpp"
#include "pipeline/frontend/redundancy.hpp"
#include "pipeline/frontend/triangulate.hpp"
#include "pipeline/geometry/camera.hpp"

namespace povslam {

class Keyframer {
 public:
  Keyframer(const PinholeCamera& camera, const FrontendOptions& options);

  // Whether a tracked frame shows enough that the map does not know. num_inliers: landmarks that fit in this frame.
  // On known ground, where an earlier visit's keyframe of about this view kept hardly more landmarks, none is.
  bool wanted(const Frame& frame, const Map& map, std::int32_t newest, int num_inliers, bool weak);

  // Keeps the frame: landmarks it saw get a sighting, features with depth that saw none become landmarks.
  std::int32_t insert(Map& map, const FrameBuilder& images, Frame& frame, const Matrix6d& covariance,
                      std::int64_t parent_id);

  // Forgets landmarks that did not prove themselves and keyframes whose landmarks others see as well.
  void cull(Map& map, std::int32_t newest);

 private:
  void create_landmarks(Map& map, const FrameBuilder& images, Frame& frame, std::int32_t slot);
  void triangulate_landmarks(Map& map, const FrameBuilder& images, Frame& frame, std::int32_t slot);
  void put_on_probation(const Map& map, std::int32_t landmark);
  void keep_look(Map& map, const FrameBuilder& images, const Frame& frame, int feature, std::int32_t landmark) const;
  bool covered(const Frame& frame, const Map& map, const Keyframe& newest, int num_inliers) const;
  bool settled(const Keyframe& keyframe, std::int64_t newest_id, std::int64_t now_index) const;
  void cull_landmarks(Map& map, std::int64_t now);
  bool cull_same_view(Map& map, std::int32_t newest) const;
  bool cull_redundant(Map& map, std::int32_t newest) const;

  PinholeCamera camera_;
  MapOptions options_;
  Triangulator triangulator_;
  KeyframeRoom keyframe_room_;
  LandmarkRoom landmark_room_;
  int most_inliers_ = 0;  // since the last keyframe: how many landmarks a frame like it sees
  struct Recent {
    std::int32_t slot;
    std::uint32_t generation;
  };
  std::vector<Recent> recent_;  // landmarks on probation
};

}  // namespace povslam
