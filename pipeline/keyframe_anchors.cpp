#include "pipeline/keyframe_anchors.hpp"

#include <algorithm>

namespace povslam {
namespace {

constexpr double kMovedM = 0.01, kMovedRad = 0.0017;

}  // namespace

void KeyframeAnchors::hang_on(std::int64_t keyframe, const Rigid3& T_world_keyframe) {
  auto at = std::ranges::lower_bound(anchors_, keyframe, {}, &Anchor::keyframe);
  if (at != anchors_.end() && at->keyframe == keyframe) return;
  at = anchors_.insert(at, {keyframe, T_world_keyframe});
  if (anchors_.size() > kMost) anchors_.erase(anchors_.begin());
}

void KeyframeAnchors::collect(const PoseOf& pose_of, std::vector<KeyframeMotion>& motions) {
  motions.clear();
  for (Anchor& anchor : anchors_) {
    const std::optional<Rigid3> T_world_keyframe = pose_of(anchor.keyframe);
    if (!T_world_keyframe) continue;
    const Rigid3 T_new_old = *T_world_keyframe * anchor.T_world_keyframe.inverse();
    const double way_m = (T_world_keyframe->translation - anchor.T_world_keyframe.translation).norm();
    if (way_m < kMovedM && rotation_angle_rad(T_new_old) < kMovedRad) continue;
    motions.push_back({anchor.keyframe, T_new_old});
    anchor.T_world_keyframe = *T_world_keyframe;
  }
}

}  // namespace povslam
