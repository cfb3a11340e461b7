// What must hold of a map whatever was done to it.
#pragma once

#include <set>
#include <string>

#include "pipeline/frontend/map.hpp"

namespace povslam {

// What is wrong with the map's sightings, empty when nothing is.
inline std::string broken_sightings(const Map& map) {
  int keyframes = 0, landmarks = 0;
  std::size_t seen_by_keyframes = 0, seen_by_landmarks = 0;
  for (std::int32_t s = 0; s < map.keyframe_slots(); ++s) {
    const Keyframe& kf = map.keyframe(s);
    if (!kf.alive) continue;
    ++keyframes;
    for (std::size_t f = 0; f < kf.landmark.size(); ++f) {
      if (kf.landmark[f] == kNone) continue;
      ++seen_by_keyframes;
      const Landmark& point = map.landmark(kf.landmark[f]);
      if (!point.alive) return "a keyframe sees a dead landmark";
      int listed = 0;
      for (int i = 0; i < point.num_sightings; ++i) {
        const LandmarkSighting& sighting = point.sightings[static_cast<std::size_t>(i)];
        if (sighting.keyframe == s && sighting.feature == static_cast<int>(f)) ++listed;
      }
      if (listed != 1) return "a landmark lists a sighting " + std::to_string(listed) + " times";
    }
  }
  for (std::int32_t l = 0; l < map.landmark_slots(); ++l) {
    const Landmark& point = map.landmark(l);
    if (!point.alive) continue;
    ++landmarks;
    if (point.num_sightings == 0) return "a landmark lives that nothing sees";
    std::set<std::int32_t> by;
    for (int i = 0; i < point.num_sightings; ++i) {
      const LandmarkSighting& sighting = point.sightings[static_cast<std::size_t>(i)];
      ++seen_by_landmarks;
      if (!map.keyframe(sighting.keyframe).alive) return "a landmark is seen by a removed keyframe";
      if (!by.insert(sighting.keyframe).second) return "a keyframe sees a landmark twice";
      if (map.keyframe(sighting.keyframe).landmark[static_cast<std::size_t>(sighting.feature)] != l) {
        return "a keyframe does not know of its sighting";
      }
    }
    if (!by.contains(point.anchor)) return "a landmark hangs on a keyframe that does not see it";
  }
  if (seen_by_keyframes != seen_by_landmarks) return "sightings are counted differently from both sides";
  if (keyframes != map.num_keyframes() || landmarks != map.num_landmarks()) return "the counts are wrong";
  return "";
}

inline std::int32_t weight_of(const Keyframe& kf, std::int32_t other) {
  for (int c = 0; c < kf.num_covisible; ++c) {
    const Covisible& covisible = kf.covisible[static_cast<std::size_t>(c)];
    if (covisible.keyframe == other) return covisible.weight;
  }
  return 0;
}

// symmetric: no list was ever full.
inline std::string broken_covisibility(const Map& map, bool symmetric) {
  for (std::int32_t s = 0; s < map.keyframe_slots(); ++s) {
    const Keyframe& kf = map.keyframe(s);
    if (!kf.alive) continue;
    std::set<std::int32_t> others;
    for (int c = 0; c < kf.num_covisible; ++c) {
      const Covisible& covisible = kf.covisible[static_cast<std::size_t>(c)];
      if (covisible.keyframe == s || !map.keyframe(covisible.keyframe).alive) return "a neighbour is itself or gone";
      if (!others.insert(covisible.keyframe).second) return "a neighbour is listed twice";
      if (c > 0 && covisible.weight > kf.covisible[static_cast<std::size_t>(c - 1)].weight) return "not in order";
      if (symmetric && weight_of(map.keyframe(covisible.keyframe), s) != covisible.weight) return "one-sided";
    }
  }
  return "";
}

}  // namespace povslam
