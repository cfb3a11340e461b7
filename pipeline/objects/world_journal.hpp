// What became of objects, voxels and events since it was last told: the world's rows for the store.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "pipeline/mapping/empty_space.hpp"
#include "pipeline/objects/library.hpp"
#include "pipeline/objects/world_rows.hpp"

namespace povslam {

class WorldJournal {
 public:
  // Events decided since; they go out with the next change.
  void note(const std::vector<ObjectEvent>& events) { events_.insert(events_.end(), events.begin(), events.end()); }
  bool has_events() const { return !events_.empty(); }

  // Fills an empty change. What it holds counts as told.
  void collect(const ObjectLibrary& library, const Volume& structure, const EmptySpace& empty, WorldChange& change);

  // The content was read from the store: nothing of it needs telling. To be called once it is restored.
  void assume_told(const WorldContent& content, const ObjectLibrary& library, const Volume& structure);

 private:
  using Told = std::unordered_map<std::uint64_t, std::uint32_t>;  // block -> VoxelBlock::changed
  struct ToldObject {
    int observations = 0;
    double alpha = 0.0, beta = 0.0;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    double yaw = 0.0;
    Told blocks;
  };
  void collect_blocks(const Volume& volume, std::int64_t id, Told& told, WorldChange& change);
  void collect_objects(const ObjectLibrary& library, WorldChange& change);
  void collect_empty(const EmptySpace& empty, WorldChange& change);

  std::vector<ObjectEvent> events_;
  std::unordered_map<std::int64_t, ToldObject> objects_;
  Told structure_;
  std::unordered_set<std::uint64_t> cells_;  // told and not yet told to be forgotten
  TimeNs cells_until_ = 0;
};

}  // namespace povslam
