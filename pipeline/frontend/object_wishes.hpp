// Where more features are wanted: on small things that are believed to stand where the map has them and of which the
// last frame saw few landmarks. So a thing has its say, and is judged, by more than what an even spread leaves it
// Nothing is wished for a thing of which none was seen: it may be hidden. What nothing is known of counts as believed
// (features by object, not only by image cell: POV-SLAM, Qian et al., RSS 2023, section VI).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pipeline/frontend/local_map.hpp"
#include "pipeline/frontend/orb.hpp"

namespace povslam {

class ObjectWishes {
 public:
  // enough: landmarks seen of a thing, from which on it needs no more; 0: nothing is ever wished for.
  ObjectWishes(const PinholeCamera& camera, int enough);

  // For the frame after this one, which was tracked on local_map. Valid until the next call; allocates nothing.
  std::span<const FeatureWish> after(const Map& map, const LocalMap& local_map, const Frame& frame);

 private:
  struct Thing {
    std::int64_t owner;
    int seen;
    FeatureWish extent;
  };
  Thing* find(std::int64_t owner);
  FeatureWish as_delivered(const FeatureWish& rectified) const;

  PinholeCamera camera_;
  int enough_;
  std::vector<Thing> things_;
  std::vector<FeatureWish> wishes_;
};

}  // namespace povslam
