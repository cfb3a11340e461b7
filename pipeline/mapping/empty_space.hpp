// Where space was seen empty, and when: a coarse memory beside the fine map, so that a thing found later is known to
// have come. Bounded: cells looked at longest ago go first.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "pipeline/mapping/depth_view.hpp"

namespace povslam {

struct EmptySpaceOptions {
  double cell_size_m = 0.1;
  int max_cells = 400000;
};

class EmptySpace {
 public:
  explicit EmptySpace(const EmptySpaceOptions& options, const DepthNoise& noise = {});
  // A cell is seen empty when every measured pixel it may cover, and at least the one at its middle, lies clearly (by 3
  // sigma) behind all of it. Cells partly outside of the picture are not.
  void observe(const DepthView& view);

  struct Seen {
    TimeNs first = 0, last = 0;  // stamps of the views
    int times = 0;
  };
  std::optional<Seen> at(const Eigen::Vector3d& p_world) const;  // nothing: never seen empty
  int num_cells() const { return num_cells_; }

  // For the store. Cell x covers [x, x + 1) cell sizes.
  struct Cell {
    std::int32_t x = 0, y = 0, z = 0;
    Seen seen;
  };
  std::vector<Cell> cells(TimeNs seen_since) const;  // whose last look is not earlier, in no special order
  void restore(const Cell& cell);

 private:
  static constexpr int kEdge = 4;  // cells of a block
  struct Block {
    std::array<Seen, kEdge * kEdge * kEdge> cells{};  // times 0: never seen empty
    TimeNs last = 0;                                  // of all cells
    int used = 0;
  };
  void observe_block(const DepthView& view, const class NearestDepth& nearest, std::uint64_t key);
  void see(std::uint64_t key, std::size_t cell, const Seen& seen);
  void forget_oldest();

  EmptySpaceOptions options_;
  DepthNoise noise_;
  std::unordered_map<std::uint64_t, Block> blocks_;
  int num_cells_ = 0;
};

}  // namespace povslam
