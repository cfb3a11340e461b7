#include "pipeline/frontend/track_state.hpp"

namespace povslam {

const char* to_string(TrackState state) {
  switch (state) {
    case TrackState::initialising:
      return "INITIALISING";
    case TrackState::ok:
      return "OK";
    case TrackState::degraded:
      return "DEGRADED";
    case TrackState::lost:
      return "LOST";
  }
  return "?";
}

}  // namespace povslam
