// Boxes that count as one: joined until no two are the same thing.
#pragma once

#include <cstddef>
#include <vector>

#include "tools/povslam/scores/oriented_box.hpp"

namespace povslam::scores {

// Item: has `box` and `required`; a joined item is required if one of its parts is.
template <class Item, class SameThing>
std::vector<Item> join_where(std::vector<Item> items, const SameThing& same_thing) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    for (std::size_t j = i + 1; j < items.size();) {
      if (!same_thing(items[i], items[j])) {
        ++j;
        continue;
      }
      items[i].box = joined(items[i].box, items[j].box);
      items[i].required = items[i].required || items[j].required;
      items.erase(items.begin() + static_cast<std::ptrdiff_t>(j));
      j = i + 1;  // the larger box may touch what the smaller did not
    }
  }
  return items;
}

}  // namespace povslam::scores
