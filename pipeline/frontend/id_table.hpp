// id -> slot of what is alive: open addressing with linear probing in a table of fixed size, never more than half full.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/base/expects.hpp"

namespace povslam {

class IdTable {
 public:
  explicit IdTable(std::size_t max_ids) {
    std::size_t size = 4;
    while (size < 2 * max_ids) size *= 2;
    entries_.resize(size);
  }

  // Ids are not negative and not there yet.
  void insert(std::int64_t id, std::int32_t slot) {
    EXPECTS(id >= 0 && ++count_ <= entries_.size() / 2);
    std::size_t i = home(id);
    while (entries_[i].id >= 0) i = next(i);
    entries_[i] = {id, slot};
  }

  std::int32_t find(std::int64_t id) const {  // -1: not there
    if (id < 0) return -1;
    for (std::size_t i = home(id); entries_[i].id >= 0; i = next(i)) {
      if (entries_[i].id == id) return entries_[i].slot;
    }
    return -1;
  }

  void erase(std::int64_t id) {
    std::size_t hole = home(id);
    while (entries_[hole].id != id) {
      EXPECTS(entries_[hole].id >= 0);
      hole = next(hole);
    }
    // What stands behind the hole and could not stand at its own place moves up, so that probing never ends early.
    for (std::size_t i = next(hole); entries_[i].id >= 0; i = next(i)) {
      const std::size_t wish = home(entries_[i].id);
      const bool may_move = hole <= i ? wish <= hole || wish > i : wish <= hole && wish > i;
      if (!may_move) continue;
      entries_[hole] = entries_[i];
      hole = i;
    }
    entries_[hole] = {};
    --count_;
  }

 private:
  struct Entry {
    std::int64_t id = -1;
    std::int32_t slot = -1;
  };
  std::size_t home(std::int64_t id) const {
    return static_cast<std::size_t>((static_cast<std::uint64_t>(id) * 0x9E3779B97F4A7C15ULL) >> 32) &
           (entries_.size() - 1);
  }
  std::size_t next(std::size_t i) const { return (i + 1) & (entries_.size() - 1); }

  std::vector<Entry> entries_;
  std::size_t count_ = 0;
};

}  // namespace povslam
