#include "pipeline/frontend/map_places.hpp"

namespace povslam {

MapPlaces::MapPlaces(int max_features, const MapOptions& options)
    : vocabulary_(Vocabulary::shipped()),
      index_(vocabulary_, options.max_keyframes, max_features),
      known_(static_cast<std::size_t>(options.max_keyframes), -1) {}

void MapPlaces::update(Map& map, bool words_there) {
  for (std::int32_t slot = 0; slot < map.keyframe_slots(); ++slot) {
    Keyframe& kf = map.keyframe(slot);
    std::int64_t& known = known_[static_cast<std::size_t>(slot)];
    const std::int64_t present = kf.alive ? kf.id : -1;
    if (known == present) continue;
    index_.remove(slot);
    known = present;
    if (!kf.alive) continue;
    if (!words_there) vocabulary_.words(kf.descriptor, kf.word);
    index_.add(slot, kf.word);
  }
}

}  // namespace povslam
