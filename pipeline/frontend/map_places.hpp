// The index of places kept in step with the map's keyframes.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/frontend/map.hpp"
#include "pipeline/frontend/place_index.hpp"
#include "pipeline/frontend/vocabulary.hpp"

namespace povslam {

class MapPlaces {
 public:
  MapPlaces(int max_features, const MapOptions& options);

  // Takes in keyframes that came, and their words into the map; forgets those that went.
  // words_there: keyframes that came have their words already.
  void update(Map& map, bool words_there = false);

  PlaceIndex& index() { return index_; }
  std::uint64_t vocabulary() const { return vocabulary_.fingerprint(); }

 private:
  const Vocabulary& vocabulary_;
  PlaceIndex index_;
  std::vector<std::int64_t> known_;  // keyframe id by slot, -1
};

}  // namespace povslam
