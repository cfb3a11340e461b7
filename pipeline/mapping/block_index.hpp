// Where the blocks of a volume are, by their keys: open addressing with linear probing, so that a look-up mostly reads
// one cache line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace povslam {

struct BlockKey {  // of the block that holds voxels 8 * key … 8 * key + 7; voxel i covers [i, i + 1) voxel sizes
  std::int32_t x = 0, y = 0, z = 0;
  bool operator==(const BlockKey&) const = default;
};

class BlockIndex {
 public:
  int find(const BlockKey& key) const;       // -1: not there
  void set(const BlockKey& key, int index);  // index >= 0; made or changed
  void remove(const BlockKey& key);          // nothing happens if it is not there
  void clear();

 private:
  struct Slot {
    BlockKey key;
    std::int32_t index = -1;  // -1: empty
  };
  std::size_t home(const BlockKey& key) const;
  std::size_t slot_of(const BlockKey& key) const;  // its own, or the empty one it would get
  std::size_t next(std::size_t slot) const { return (slot + 1) & (slots_.size() - 1); }
  void grow();

  std::vector<Slot> slots_;  // a power of two, at most half full; or none
  std::size_t used_ = 0;
};

}  // namespace povslam
