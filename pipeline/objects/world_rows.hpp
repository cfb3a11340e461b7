// Objects, voxels and events as plain values: what is written to disk, piece by piece, and read back whole.
// Beside the sparse map's rows (frontend/map_rows.hpp), committed in the same way.
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/objects/object_event.hpp"

namespace povslam {

struct ObjectRow {
  ObjectRecord object;
  double voxel_size_m = 0.05, truncation_m = 0.2;  // of its volume
  Rigid3 T_world_volume;
  bool announced = false;  // an event said that it came
};

struct VoxelBlockRow {      // pipeline/mapping/volume.hpp VoxelBlock
  std::int64_t volume = 0;  // object id, kStructureVolume
  std::int32_t x = 0, y = 0, z = 0;
  std::vector<std::int16_t> distance;  // kBlockVoxels, or empty arrays: the block is gone
  std::vector<std::uint16_t> weight;
  std::vector<std::uint8_t> color;  // 3 * kBlockVoxels
};
inline constexpr std::int64_t kStructureVolume = -1;

struct EmptyCellRow {  // pipeline/mapping/empty_space.hpp
  std::int32_t x = 0, y = 0, z = 0;
  TimeNs first = 0, last = 0;
  std::int32_t times = 0;  // 0: forgotten, the row goes
};

struct WorldMeta {
  std::int64_t next_object = 0;  // ids not used yet
  std::int64_t next_event_seq = 0;
  TimeNs first_visit_end = 0;
};

// The whole, or what became of it since the last change: rows replace older ones of the same id.
struct WorldChange {
  WorldMeta meta;
  std::vector<ObjectRow> objects;
  std::vector<std::int64_t> removed_objects;  // with the blocks of their volumes
  std::vector<VoxelBlockRow> blocks;
  std::vector<EmptyCellRow> empty_cells;
  std::vector<ObjectEvent> events;  // new ones; never change once made

  bool empty() const {
    return objects.empty() && removed_objects.empty() && blocks.empty() && empty_cells.empty() && events.empty();
  }
  void clear() { *this = WorldChange{}; }
};
using WorldContent = WorldChange;

}  // namespace povslam
