// Where a thing's front ends only because something nearer stands before the rest of it: a post, what lies on the
// floor. There its box may go on as far as it was hidden.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>

#include "pipeline/mapping/depth_view.hpp"
#include "pipeline/objects/observation.hpp"

namespace povslam {

struct SeenBox;

// The upright side of a box that was seen most, and its ends.
struct FrontSide {
  int across = 0;     // the box's axis it faces along
  bool plus = false;  // to that axis's plus side
  int along() const { return 1 - across; }
};
std::optional<FrontSide> front_side(const SeenBox& seen);  // none was seen

// How far what lies beyond an end of the front was hidden in the views that showed the front [m].
struct HiddenReach {
  double minus_m = 0.0, plus_m = 0.0;  // along the front
  double below_m = 0.0;
};

class HiddenEnds {
 public:
  static constexpr double kStep_m = 0.05;

  // One more view that showed the thing. seen: in the volume's frame.
  void look(const SeenBox& seen, const Rigid3& T_world_volume, const DepthView& view);
  HiddenReach reach(const SeenBox& seen) const;
  bool any() const { return !spots_.empty(); }

 private:
  struct Votes {  // views that measured something before the front's plane, on it, behind
    std::uint8_t hidden = 0, at = 0, behind = 0;
    int last_view = -1;  // each has one vote
  };
  using Spot = std::array<int, 3>;  // of the volume's frame; level ones hold for all heights and the other way round
  Votes of(const Spot& spot) const;

  std::map<Spot, Votes> spots_;
  int views_ = 0;
};

}  // namespace povslam
