// Chooses among the corners of one level so that the chosen lie evenly: every cell of the level gets the same share,
// what a cell cannot use goes to the others, and inside of a cell no small patch gets a second feature before every
// patch had its first.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/frontend/kernels/kernels.hpp"
#include "pipeline/frontend/orb.hpp"

namespace povslam {

class CornerSpread {
 public:
  // area: where corners may lie. cell_px: edge of a cell (cells are made to fit the area evenly).
  CornerSpread(PixelRect area, int cell_px);

  // Cells of which a wish holds a quarter, or that hold its middle, get twice the share of others from now on.
  // scale: level-0 px per px of this level.
  void favour(std::span<const FeatureWish> wishes, float scale);

  // Moves at most `wanted` of the first `count` corners (in raster order) to the front, sorted by cell row, then cell,
  // then preference, and returns how many. Corners below good_score are taken only in cells that have no better ones,
  // and there at most half an even share: the next image shows fewer of them again.
  int choose(FastCorner* corners, int count, int wanted, int good_score);

 private:
  struct Cell {
    int good = 0;  // candidates at or above good_score
    int all = 0;
    int taken = 0;
  };
  bool holds(int column, int row, const FeatureWish& wish, float scale) const;

  void collect(const FastCorner* corners, int count);
  void rank(const FastCorner* corners, int good_score);
  // Raises every cell's `taken` towards `available(cell)` by water-filling with at most `budget` corners.
  template <class Available>
  void share_out(int budget, Available available);

  PixelRect area_;
  int cell_columns_, cell_rows_, patches_;               // patches_: per cell and axis
  std::vector<std::uint16_t> patch_column_, patch_row_;  // of each pixel column and row of the area
  std::vector<std::uint64_t> best_;                      // two per patch: score and index of its best corners
  std::vector<Cell> cells_;
  std::vector<std::uint8_t> shares_;       // of each cell, 1: an ordinary one
  std::vector<std::uint64_t> candidates_;  // per cell 2 * patches_^2 keys, best first
  std::vector<std::uint64_t> contest_;
  std::vector<FastCorner> chosen_;
};

}  // namespace povslam
