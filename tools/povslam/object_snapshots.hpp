// Puts the parts of object_list_t together again.
#pragma once

#include <optional>
#include <povslam/object_list_t.hpp>
#include <vector>

namespace povslam {

class ObjectSnapshots {
 public:
  // All objects once the snapshot that `part` belongs to is whole, in order of parts; else nothing. Parts may come in
  // any order and twice; of a newer snapshot the first part gives the older one up. What contradicts itself is left
  // out.
  std::optional<std::vector<object_t>> add(const object_list_t& part);

 private:
  std::int64_t session_ = 0, snapshot_ = -1;
  bool told_ = false;
  std::vector<std::optional<object_list_t>> parts_;
};

}  // namespace povslam
