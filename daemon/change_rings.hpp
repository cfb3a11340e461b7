// Changes of the map and of what stands in it, on their way to the disk and back to their owners once they are there.
#pragma once

#include "pipeline/base/spsc_ring.hpp"
#include "pipeline/frontend/map_rows.hpp"
#include "pipeline/objects/world_rows.hpp"

namespace povslam {

template <class Change>
struct ChangeWay {
  static constexpr std::size_t kCapacity = 2;  // an owner hands out one at a time
  ChangeWay(Doorbell* store_bell, Doorbell* owner_bell) : taken(kCapacity, store_bell), stored(kCapacity, owner_bell) {}

  SpscRing<Change*> taken;   // owner -> store
  SpscRing<Change*> stored;  // back
};

struct ChangeRings {
  // world_bell: rung when a change of the world comes back; null: its owner does not sleep for it.
  explicit ChangeRings(Doorbell* world_bell = nullptr) : map(&bell, nullptr), world(&bell, world_bell) {}
  void close() {
    map.taken.close();
    world.taken.close();
  }

  Doorbell bell;  // of all that is taken
  ChangeWay<MapChange> map;
  ChangeWay<WorldChange> world;
};

}  // namespace povslam
