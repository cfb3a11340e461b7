#pragma once

namespace povslam {

// Places recognised that nothing tracked joined to here.
struct LoopCounts {
  int suspected = 0;  // keyframes that showed an old place
  int closed = 0;     // the map was corrected
  int joined = 0;     // old place found where it should be: landmarks were joined, nothing moved
  int refused = 0;    // the backend found no way to fit it
};

}  // namespace povslam
