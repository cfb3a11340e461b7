// Which of a box's upright sides a camera saw.
//
// A side counts as seen when at least half of a 10 x 10 grid of points on it were each seen (visibility.hpp) in 3
// frames or more, from no further than 6 m and no flatter than 15 degrees to the side. A box's sides were seen when two
// that meet were: then nothing of its footprint need be guessed.
#pragma once

#include <array>

#include "tools/povslam/scores/visibility.hpp"

namespace povslam::scores {

class SideSightings {
 public:
  explicit SideSightings(const OrientedBox& box);
  void look(const TrueView& view);
  bool seen(std::size_t side) const;  // +x, -x, +y, -y of the box
  bool two_that_meet() const { return (seen(0) || seen(1)) && (seen(2) || seen(3)); }

 private:
  static constexpr std::size_t kGrid = 10;
  struct Side {
    Eigen::Vector3d normal_world;
    std::array<Eigen::Vector3d, kGrid * kGrid> points_world;
    std::array<int, kGrid * kGrid> frames{};
  };
  std::array<Side, 4> sides_;
};

}  // namespace povslam::scores
