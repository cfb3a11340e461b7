// Where space was seen empty, and when: a coarse memory beside the fine map, so that a thing found later is known to
// have come. Bounded: cells looked at longest ago go first.
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>

#include "pipeline/mapping/depth_view.hpp"

namespace povslam {

struct EmptySpaceOptions {
  double cell_size_m = 0.1;
  int max_cells = 400000;
};

class EmptySpace {
 public:
  explicit EmptySpace(const EmptySpaceOptions& options);
  // A cell is seen empty when every measured pixel it may cover, and at least one, lies clearly behind all of it.
  void observe(const DepthView& view);

  struct Seen {
    TimeNs first = 0, last = 0;  // stamps of the views
    int times = 0;
  };
  std::optional<Seen> at(const Eigen::Vector3d& p_world) const;  // nothing: never seen empty
  int num_cells() const;

 private:
  EmptySpaceOptions options_;
  struct Cells;
};

}  // namespace povslam
