// What stands somewhere, as it grows and changes: objects with voxels, structure, empty cells, events. Each change
// comes with what the whole then is, so that a store can be held against it. Beside made_map.hpp.
#pragma once

#include <array>
#include <map>
#include <random>
#include <vector>

#include "pipeline/mapping/volume.hpp"
#include "pipeline/objects/world_rows.hpp"

namespace povslam::made {

// What a reader has after applying changes in order.
class WorldTruth {
 public:
  using Place = std::array<std::int64_t, 4>;  // volume (of blocks), x, y, z

  void apply(const WorldChange& change) {
    meta = change.meta;
    for (const auto& row : change.objects) objects[row.object.id] = row;
    for (const auto& row : change.blocks) {
      blocks[{row.volume, row.x, row.y, row.z}] = row;
      if (row.weight.empty()) blocks.erase({row.volume, row.x, row.y, row.z});
    }
    for (const auto& row : change.empty_cells) {
      empty_cells[{0, row.x, row.y, row.z}] = row;
      if (row.times == 0) empty_cells.erase({0, row.x, row.y, row.z});
    }
    for (const auto& row : change.events) events[row.seq] = row;
    for (const std::int64_t id : change.removed_objects) {
      objects.erase(id);
      std::erase_if(blocks, [id](const auto& entry) { return entry.second.volume == id; });
    }
  }
  WorldContent content() const {
    WorldContent all;
    all.meta = meta;
    for (const auto& [id, row] : objects) all.objects.push_back(row);
    for (const auto& [place, row] : blocks) all.blocks.push_back(row);
    for (const auto& [place, row] : empty_cells) all.empty_cells.push_back(row);
    for (const auto& [seq, row] : events) all.events.push_back(row);
    return all;
  }

  WorldMeta meta;
  std::map<std::int64_t, ObjectRow> objects;
  std::map<Place, VoxelBlockRow> blocks;
  std::map<Place, EmptyCellRow> empty_cells;
  std::map<std::int64_t, ObjectEvent> events;
};

struct WorldPace {
  int objects = 1;      // new ones a change
  int old_objects = 2;  // seen again, a change
  int blocks = 2;       // of each object, a change
  int structure_blocks = 2;
  int empty_cells = 4;
  unsigned seed = 1;
};

class WorldMaker {
 public:
  explicit WorldMaker(const WorldPace& pace) : pace_(pace), random_(pace.seed) {}

  WorldChange next() {
    WorldChange change;
    for (int i = 0; i < pace_.objects; ++i) touch(new_object(), change);
    for (int i = 0; i < pace_.old_objects && !truth_.objects.empty(); ++i) {
      touch(truth_.objects.lower_bound(pick(0, truth_.objects.rbegin()->first))->second, change);
    }
    for (int i = 0; i < pace_.structure_blocks; ++i) change.blocks.push_back(block_of(kStructureVolume));
    for (int i = 0; i < pace_.empty_cells; ++i) {
      const auto at = [this] { return static_cast<std::int32_t>(pick(-20, 20)); };
      change.empty_cells.push_back({at(), at(), at(), ++time_, time_ + 5, static_cast<std::int32_t>(pick(0, 9))});
    }
    if (pick(0, 2) == 0) remove_one(change);
    change.meta = {next_object_, next_event_, 7 * kNsPerSecond};
    truth_.apply(change);
    return change;
  }
  const WorldTruth& truth() const { return truth_; }

 private:
  std::int64_t pick(std::int64_t low, std::int64_t high) {  // both can be
    return std::uniform_int_distribution<std::int64_t>(low, high)(random_);
  }
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Eigen::Vector3d vector() {
    const double x = uniform(-5, 5), y = uniform(-5, 5), z = uniform(0, 2);
    return {x, y, z};
  }

  ObjectRow new_object() {
    ObjectRow row;
    row.object.id = next_object_++;
    row.object.class_name = pick(0, 1) == 0 ? "box" : "pallet jack";
    row.object.size_m = {uniform(0.1, 1), uniform(0.1, 1), uniform(0.1, 1)};
    row.object.first_seen = ++time_;
    row.T_world_volume.translation = vector();
    row.T_world_volume.rotation = so3_exp({0.0, 0.0, uniform(-3, 3)});
    return row;
  }

  void touch(ObjectRow row, WorldChange& change) {
    for (const ObjectRow& already : change.objects) {
      if (already.object.id == row.object.id) return;
    }
    ObjectRecord& object = row.object;
    object.place = {vector(), uniform(-1.5, 1.5)};
    object.belief = {uniform(-0.1, 0.1), uniform(0.001, 0.2), uniform(1, 9), uniform(1, 9)};
    object.last_seen = ++time_;
    if (pick(0, 1) == 0) object.first_absent = object.last_absent = ++time_;
    object.landmarks.resize(static_cast<std::size_t>(pick(0, 30)));
    for (std::int64_t& landmark : object.landmarks) landmark = pick(0, 9);
    ++object.observations;
    object.phase = object.observations > 2 ? ObjectPhase::confirmed : ObjectPhase::tentative;
    row.announced = object.observations > 2;
    for (int i = 0; i < pace_.blocks; ++i) change.blocks.push_back(block_of(object.id));
    change.events.push_back(event_of(row));
    change.objects.push_back(std::move(row));
  }

  ObjectEvent event_of(const ObjectRow& row) {
    ObjectEvent event;
    event.seq = next_event_++;
    event.stamp = ++time_;
    event.type = static_cast<ObjectEventType>(pick(0, 2));
    event.object = row.object.id;
    event.class_name = row.object.class_name;
    event.place = row.object.place;
    event.size_m = row.object.size_m;
    if (event.type == ObjectEventType::moved) event.from = ObjectPlace{vector(), 0.1};
    event.consistency = uniform(0, 1);
    event.probability = uniform(0, 1);
    event.evidence = {row.object.first_absent, row.object.last_absent, row.object.first_seen, row.object.last_seen};
    return event;
  }

  // Now and then one that is gone.
  VoxelBlockRow block_of(std::int64_t volume) {
    VoxelBlockRow row;
    row.volume = volume;
    const std::int64_t extent = volume == kStructureVolume ? 20 : 2;
    row.x = static_cast<std::int32_t>(pick(-extent, extent));
    row.y = static_cast<std::int32_t>(pick(-extent, extent));
    row.z = static_cast<std::int32_t>(pick(-2, 2));
    if (pick(0, 9) == 0) return row;
    row.distance.resize(kBlockVoxels);
    row.weight.resize(kBlockVoxels);
    row.color.resize(3 * kBlockVoxels);
    for (std::size_t i = 0; i < kBlockVoxels; ++i) {
      if (i % 8 > 4) continue;  // never seen
      row.weight[i] = static_cast<std::uint16_t>(pick(1, 6400));
      row.distance[i] = static_cast<std::int16_t>(pick(-kDistanceUnits, kDistanceUnits));
      for (std::size_t c = 0; c < 3; ++c) row.color[3 * i + c] = static_cast<std::uint8_t>(random_());
    }
    return row;
  }

  void remove_one(WorldChange& change) {
    if (truth_.objects.empty()) return;
    change.removed_objects.push_back(truth_.objects.lower_bound(pick(0, truth_.objects.rbegin()->first))->first);
  }

  WorldPace pace_;
  std::mt19937_64 random_;
  WorldTruth truth_;
  std::int64_t next_object_ = 0, next_event_ = 0;
  TimeNs time_ = 0;
};

}  // namespace povslam::made
