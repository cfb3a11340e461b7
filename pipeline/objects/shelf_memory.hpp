// Shelves over views: seen from the side, or full of things, a board is not told from what stands on it; other views of
// the same place do tell it.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "pipeline/objects/segment_grid.hpp"

namespace povslam {

class ShelfMemory {
 public:
  // boards: where this view shows boards, level axes of the grid, whose origin lies below camera_world. Afterwards
  // cells where three views showed a board, and no more than four times as many something else, are labelled
  // kStructurePart. True: some were not labelled before.
  bool learn_and_mark(std::span<const Eigen::Vector3f> boards, const Eigen::Vector2d& camera_world, SegmentGrid& grid);

 private:
  struct Place {
    std::uint32_t boards = 0, others = 0;  // views that showed a board here, or something else
    std::uint32_t last_board = 0, last_other = 0;
  };
  void vote(const Eigen::Vector3f& board);

  std::unordered_map<std::int64_t, Place> places_;
  std::vector<std::uint8_t> levels_;  // that hold any place
  std::uint32_t view_ = 0;
  Eigen::Vector2f camera_ = Eigen::Vector2f::Zero();  // world; the grid is level with it
};

}  // namespace povslam
