// Other places where the variational EM of a window can be begun: where many of its objects, alone or two at a time,
// would stand as the map has them, and others with them. For a window whose own start leads to the nearest answer
// instead of the best; docs/vem.md, "Other starts". Not in the paper.
#pragma once

#include <span>
#include <vector>

#include "pipeline/backend/window.hpp"

namespace povslam {

struct VemStart {
  Rigid3 T_start_window;  // moves all poses of the window, as a body: a turn about z, and a shift
  double support = 0.0;   // matches that it brings to their landmarks, of a thinned selection, near ones more than far
};

// At most `count`, best first. They differ from each other, and from what took the window's poses to `solved`, by more
// than a match is off. Of a window without fault; deterministic.
std::vector<VemStart> other_starts(const VemWindow& window, std::span<const Rigid3> solved, int count);

}  // namespace povslam
