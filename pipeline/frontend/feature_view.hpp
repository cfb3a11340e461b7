// The features of a frame or of a keyframe, to be looked for in the map. Spans of one length, by feature; they point
// into what they were made of.
#pragma once

#include "pipeline/frontend/frame.hpp"
#include "pipeline/frontend/keyframe.hpp"

namespace povslam {

struct FeatureView {
  explicit FeatureView(const Frame& frame)
      : x(first(frame, frame.x)),
        y(first(frame, frame.y)),
        sigma_px(first(frame, frame.sigma_px)),
        inverse_depth(first(frame, frame.inverse_depth)),
        sigma_inverse_depth(first(frame, frame.sigma_inverse_depth)),
        level(first(frame, frame.features.level)),
        descriptor(first(frame, frame.features.descriptor)) {}
  explicit FeatureView(const Keyframe& keyframe)
      : x(keyframe.x),
        y(keyframe.y),
        sigma_px(keyframe.sigma_px),
        inverse_depth(keyframe.inverse_depth),
        sigma_inverse_depth(keyframe.sigma_inverse_depth),
        level(keyframe.level),
        descriptor(keyframe.descriptor) {}

  std::size_t size() const { return x.size(); }

  std::span<const float> x, y, sigma_px;                      // px, rectified
  std::span<const float> inverse_depth, sigma_inverse_depth;  // 1/m; 0 = none
  std::span<const std::uint8_t> level;
  std::span<const Descriptor> descriptor;

 private:
  template <class T>
  static std::span<const T> first(const Frame& frame, const std::vector<T>& values) {
    return {values.data(), static_cast<std::size_t>(frame.size())};
  }
};

}  // namespace povslam
