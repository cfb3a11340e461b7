// Which keyframes see the same landmarks.
#include <algorithm>

#include "pipeline/frontend/map.hpp"

namespace povslam {

void Map::drop_covisibility(std::int32_t slot) {
  Keyframe& kf = keyframe(slot);
  for (int i = 0; i < kf.num_covisible; ++i) {
    link_covisible(kf.covisible[static_cast<std::size_t>(i)].keyframe, slot, 0);
  }
  kf.num_covisible = 0;
  // Lists are bounded, so a link may be one-sided: look at every other keyframe too.
  for (std::int32_t other = 0; other < keyframe_slots(); ++other) {
    if (keyframe(other).alive && other != slot) link_covisible(other, slot, 0);
  }
}

// Sets, moves or (weight 0) removes `other` in the list of `slot`, kept heaviest first.
void Map::link_covisible(std::int32_t slot, std::int32_t other, std::int32_t weight) {
  Keyframe& kf = keyframe(slot);
  const auto begin = kf.covisible.begin();
  const auto end = begin + kf.num_covisible;
  const auto present = std::find_if(begin, end, [other](const Covisible& c) { return c.keyframe == other; });
  if (present != end) {
    std::move(present + 1, end, present);
    --kf.num_covisible;
  }
  if (weight <= 0) return;
  int place = kf.num_covisible;
  while (place > 0 && kf.covisible[static_cast<std::size_t>(place - 1)].weight < weight) --place;
  if (place >= kMaxCovisible) return;
  const int kept = std::min(kf.num_covisible, kMaxCovisible - 1);
  std::move_backward(begin + place, begin + kept, begin + kept + 1);
  kf.covisible[static_cast<std::size_t>(place)] = {other, weight};
  kf.num_covisible = kept + 1;
}

void Map::update_covisibility(std::int32_t slot) {
  constexpr std::int32_t kMinShared = 10;
  Keyframe& kf = keyframe(slot);
  for (Keyframe& other : keyframes_) other.votes = 0;
  for (const std::int32_t seen : kf.landmark) {
    if (seen == kNone) continue;
    const Landmark& point = landmark(seen);
    for (int s = 0; s < point.num_sightings; ++s) {
      ++keyframe(point.sightings[static_cast<std::size_t>(s)].keyframe).votes;
    }
  }
  for (std::int32_t other = 0; other < keyframe_slots(); ++other) {
    if (other == slot || !keyframe(other).alive) continue;
    const std::int32_t weight = keyframe(other).votes >= kMinShared ? keyframe(other).votes : 0;
    link_covisible(slot, other, weight);
    link_covisible(other, slot, weight);
  }
}

}  // namespace povslam
