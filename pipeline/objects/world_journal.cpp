#include "pipeline/objects/world_journal.hpp"

#include <algorithm>
#include <utility>

namespace povslam {
namespace {

constexpr int kBits = 21;  // of each coordinate

std::uint64_t packed(std::int32_t x, std::int32_t y, std::int32_t z) {
  const auto part = [](std::int32_t value) { return static_cast<std::uint64_t>(value) & 0x1FFFFF; };
  return part(x) | part(y) << kBits | part(z) << 2 * kBits;
}
std::int32_t part(std::uint64_t key, int index) {
  return static_cast<std::int32_t>(static_cast<std::int64_t>(key >> index * kBits << (64 - kBits)) >> (64 - kBits));
}

VoxelBlockRow row_of(const VoxelBlock& block, std::int64_t volume) {
  return {volume,
          block.key.x,
          block.key.y,
          block.key.z,
          {block.distance.begin(), block.distance.end()},
          {block.weight.begin(), block.weight.end()},
          {block.color.begin(), block.color.end()}};
}

}  // namespace

void WorldJournal::collect_blocks(const Volume& volume, std::int64_t id, Told& told, WorldChange& change) {
  for (int i = 0; i < volume.num_blocks(); ++i) {
    const VoxelBlock& block = volume.block(i);
    const auto [entry, fresh] = told.try_emplace(packed(block.key.x, block.key.y, block.key.z), block.changed);
    if (!fresh && entry->second == block.changed) continue;
    entry->second = block.changed;
    change.blocks.push_back(row_of(block, id));
  }
  for (auto entry = told.begin(); entry != told.end();) {
    const BlockKey key{part(entry->first, 0), part(entry->first, 1), part(entry->first, 2)};
    if (volume.find(key) >= 0) {
      ++entry;
      continue;
    }
    change.blocks.push_back({id, key.x, key.y, key.z, {}, {}, {}});
    entry = told.erase(entry);
  }
}

// An object that went stays in the store until the event that says so is decided: after a sudden end it is found
// missing once more.
void WorldJournal::collect_objects(const ObjectLibrary& library, WorldChange& change) {
  std::unordered_set<std::int64_t> alive;
  for (const auto& object : library.objects()) {
    if (object->phase != ObjectPhase::confirmed) continue;
    alive.insert(object->id);
    const auto [told, fresh] = objects_.try_emplace(object->id);
    collect_blocks(object->volume, object->id, told->second.blocks, change);
    ToldObject& was = told->second;
    const Belief& belief = object->belief;
    const Rigid3& T_world_volume = object->T_world_volume;
    const bool same_place = was.position == T_world_volume.translation && was.yaw == yaw_of(T_world_volume);
    const bool same_belief = was.alpha == belief.alpha && was.beta == belief.beta;
    if (!fresh && was.observations == object->observations && same_belief && same_place) continue;
    was.observations = object->observations;
    was.alpha = belief.alpha;
    was.beta = belief.beta;
    was.position = T_world_volume.translation;
    was.yaw = yaw_of(T_world_volume);
    change.objects.push_back({library.record_of(*object), object->volume.options().voxel_size_m,
                              object->volume.options().truncation_m, object->T_world_volume, true});
  }
  for (auto told = objects_.begin(); told != objects_.end();) {
    if (alive.contains(told->first) || library.undecided(told->first)) {
      ++told;
      continue;
    }
    change.removed_objects.push_back(told->first);
    told = objects_.erase(told);
  }
}

void WorldJournal::collect_empty(const EmptySpace& empty, WorldChange& change) {
  TimeNs latest = cells_until_;
  for (const EmptySpace::Cell& cell : empty.cells(cells_until_)) {
    latest = std::max(latest, cell.seen.last);
    cells_.insert(packed(cell.x, cell.y, cell.z));
    change.empty_cells.push_back({cell.x, cell.y, cell.z, cell.seen.first, cell.seen.last, cell.seen.times});
  }
  cells_until_ = latest + 1;
  if (std::ssize(cells_) <= empty.num_cells()) return;
  std::unordered_set<std::uint64_t> alive;  // some were forgotten
  for (const EmptySpace::Cell& cell : empty.cells(0)) alive.insert(packed(cell.x, cell.y, cell.z));
  for (const std::uint64_t key : cells_) {
    if (!alive.contains(key)) change.empty_cells.push_back({part(key, 0), part(key, 1), part(key, 2), 0, 0, 0});
  }
  cells_ = std::move(alive);
}

void WorldJournal::collect(const ObjectLibrary& library, const Volume& structure, const EmptySpace& empty,
                           WorldChange& change) {
  collect_objects(library, change);
  collect_blocks(structure, kStructureVolume, structure_, change);
  collect_empty(empty, change);
  change.events = std::exchange(events_, {});
  change.meta.next_object = library.next_id();
  change.meta.next_event_seq = library.next_event_seq();
}

void WorldJournal::assume_told(const WorldContent& content, const ObjectLibrary& library, const Volume& structure) {
  WorldChange restored;
  collect_objects(library, restored);
  collect_blocks(structure, kStructureVolume, structure_, restored);
  for (const EmptyCellRow& cell : content.empty_cells) {
    cells_.insert(packed(cell.x, cell.y, cell.z));
    cells_until_ = std::max(cells_until_, cell.last + 1);
  }
}

}  // namespace povslam
