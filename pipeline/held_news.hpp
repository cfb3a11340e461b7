// What understanding tells tracking of a view, held until a fixed time after that view was taken: it enters tracking at
// the same frame however long understanding took, if it came in time. Does not allocate.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "pipeline/base/time.hpp"

namespace povslam {

template <class Told>  // has `seen`, the stamp of its view
class HeldNews {
 public:
  HeldNews(TimeNs delay, int capacity) : delay_(delay) { held_.reserve(static_cast<std::size_t>(capacity)); }

  // In the order of their views. false: there is no room for all of them, and none was kept.
  bool add(std::span<const Told> told) {
    if (held_.size() + told.size() > held_.capacity()) return false;
    held_.insert(held_.end(), told.begin(), told.end());
    return true;
  }
  // Those due when a frame of this stamp is tracked, in the order they came.
  std::span<const Told> due(TimeNs stamp) const {
    const auto later = std::ranges::find_if(held_, [&](const Told& told) { return told.seen + delay_ > stamp; });
    return {held_.begin(), later};
  }
  std::span<const Told> all() const { return held_; }
  void drop(std::size_t count) { held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(count)); }

 private:
  TimeNs delay_;
  std::vector<Told> held_;
};

}  // namespace povslam
