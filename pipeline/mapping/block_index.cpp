#include "pipeline/mapping/block_index.hpp"

#include <algorithm>

namespace povslam {

std::size_t BlockIndex::home(const BlockKey& key) const {
  const auto part = [](std::int32_t value, std::uint64_t factor) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(value)) * factor;
  };
  std::uint64_t mixed =
      part(key.x, 0x9E3779B97F4A7C15ULL) ^ part(key.y, 0xC2B2AE3D27D4EB4FULL) ^ part(key.z, 0x165667B19E3779F9ULL);
  mixed ^= mixed >> 32;
  return static_cast<std::size_t>(mixed * 0x9E3779B97F4A7C15ULL >> 16) & (slots_.size() - 1);
}

std::size_t BlockIndex::slot_of(const BlockKey& key) const {
  std::size_t slot = home(key);
  while (slots_[slot].index >= 0 && !(slots_[slot].key == key)) slot = next(slot);
  return slot;
}

int BlockIndex::find(const BlockKey& key) const {
  return slots_.empty() ? -1 : slots_[slot_of(key)].index;
}

void BlockIndex::set(const BlockKey& key, int index) {
  if (2 * (used_ + 1) > slots_.size()) grow();
  Slot& slot = slots_[slot_of(key)];
  used_ += slot.index < 0 ? 1 : 0;
  slot = {key, index};
}

// What follows without a gap moves up, or it would not be found any more.
void BlockIndex::remove(const BlockKey& key) {
  if (slots_.empty()) return;
  std::size_t hole = slot_of(key);
  if (slots_[hole].index < 0) return;
  --used_;
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t slot = next(hole); slots_[slot].index >= 0; slot = next(slot)) {
    if (((slot - home(slots_[slot].key)) & mask) < ((slot - hole) & mask)) continue;
    slots_[hole] = slots_[slot];
    hole = slot;
  }
  slots_[hole] = {};
}

void BlockIndex::clear() {
  slots_.clear();
  used_ = 0;
}

void BlockIndex::grow() {
  constexpr std::size_t kLeast = 16;
  std::vector<Slot> before(std::max(kLeast, 2 * slots_.size()));
  before.swap(slots_);
  for (const Slot& slot : before) {
    if (slot.index >= 0) slots_[slot_of(slot.key)] = slot;
  }
}

}  // namespace povslam
