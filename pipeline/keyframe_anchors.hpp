// Where the keyframes were that views were hung on, so that it can be told how far they have been moved since.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "pipeline/objects/keyframe_motion.hpp"

namespace povslam {

class KeyframeAnchors {
 public:
  using PoseOf = std::function<std::optional<Rigid3>(std::int64_t keyframe)>;

  // A view hangs on the keyframe, which is there now. The first pose told counts.
  void hang_on(std::int64_t keyframe, const Rigid3& T_world_keyframe);
  // Those that have moved since, by ascending keyframe; from now on they count as told. Moved: by more than 1 cm or
  // 0.1 deg, which is what bundle adjustment does every second.
  void collect(const PoseOf& pose_of, std::vector<KeyframeMotion>& motions);

 private:
  static constexpr std::size_t kMost = 1 << 14;  // the oldest are forgotten: what hangs on them stays where it is
  struct Anchor {
    std::int64_t keyframe = -1;
    Rigid3 T_world_keyframe;
  };
  std::vector<Anchor> anchors_;  // by ascending keyframe
};

}  // namespace povslam
