// What variational EM beside tracking came to, since the start.
#pragma once

#include <cstdint>

namespace povslam {

struct VemCounts {
  std::int64_t runs = 0, iterations = 0, matches = 0, landmarks = 0;  // sums over runs
  std::int64_t faults = 0;                                            // windows refused: our mistake
  std::int64_t doubted = 0, believed_again = 0;                       // objects
  std::int64_t corrections = 0;                                       // of the pose
};

}  // namespace povslam
