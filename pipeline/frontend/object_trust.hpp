// How far landmarks of each object are to be trusted: what is believed of the object's standing where it was (E[v]), 0
// for one that is believed to be elsewhere. Of a fixed number of objects; no allocation after construction.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "pipeline/frontend/id_table.hpp"

namespace povslam {

class ObjectTrust {
 public:
  explicit ObjectTrust(std::size_t max_objects) : slot_of_id_(max_objects), trust_(max_objects, 1.0F) {
    for (std::size_t slot = max_objects; slot-- > 0;) free_.push_back(static_cast<std::int32_t>(slot));
  }

  // 1 for what nothing is known of: structure, things never told of, and those that found no room here.
  float of(std::int64_t object) const {
    const std::int32_t slot = slot_of_id_.find(object);
    return slot < 0 ? 1.0F : trust_[static_cast<std::size_t>(slot)];
  }

  void set(std::int64_t object, double trust) {
    std::int32_t slot = slot_of_id_.find(object);
    if (slot < 0) {
      if (object < 0 || free_.empty()) return;
      slot = free_.back();
      free_.pop_back();
      slot_of_id_.insert(object, slot);
    }
    trust_[static_cast<std::size_t>(slot)] = static_cast<float>(std::clamp(trust, 0.0, 1.0));
  }

  void forget(std::int64_t object) {
    const std::int32_t slot = slot_of_id_.find(object);
    if (slot < 0) return;
    slot_of_id_.erase(object);
    free_.push_back(slot);
  }

 private:
  IdTable slot_of_id_;
  std::vector<float> trust_;
  std::vector<std::int32_t> free_;
};

}  // namespace povslam
