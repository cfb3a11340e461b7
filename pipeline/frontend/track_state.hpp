#pragma once

#include <cstdint>

namespace povslam {

enum class TrackState : std::uint8_t {
  initialising = 0,  // no map yet
  ok = 1,
  degraded = 2,  // a pose, but weakly supported: covariance is large, do not drive fast on it
  lost = 3       // no pose: the last one is held with growing covariance while the map is searched
};
const char* to_string(TrackState state);

}  // namespace povslam
