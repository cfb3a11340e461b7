// On which things matched landmarks lie. A thing that was carried looks as it would to a camera that was; two things,
// or a thing and a wall, do not move alike. So one thing alone does not say where the camera is.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace povslam {

class ThingCount {
 public:
  explicit ThingCount(std::size_t max_things) { things_.reserve(max_things); }

  void clear() { things_.clear(), all_ = known_ = 0; }
  void add(std::int64_t owner) {  // of a landmark, see Landmark
    ++all_;
    if (owner < 0) return;
    ++known_;
    if (owner == 0) return;
    const auto thing = std::ranges::find(things_, owner, &Thing::id);
    if (thing != things_.end()) {
      ++thing->landmarks;
    } else if (things_.size() < things_.capacity()) {
      things_.push_back({owner, 1});
    }
  }

  // Most of the landmarks are of one object, and hardly any of others or of structure, as far as it is known.
  bool hangs_on_one() const {
    int most = 0;
    for (const Thing& thing : things_) most = std::max(most, thing.landmarks);
    return most > kMostShare * all_ && known_ - most < std::max(kMinOfOthers, kOthersShare * most);
  }

 private:
  static constexpr double kMostShare = 0.5, kMinOfOthers = 15.0, kOthersShare = 0.2;
  struct Thing {
    std::int64_t id;
    int landmarks;
  };
  std::vector<Thing> things_;
  int all_ = 0, known_ = 0;
};

}  // namespace povslam
