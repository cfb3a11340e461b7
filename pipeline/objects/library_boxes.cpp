// What is assumed of things' boxes where they were not seen: as things of their class are wont to be, between their
// neighbours.
#include <algorithm>
#include <cmath>

#include "pipeline/objects/library.hpp"
#include "pipeline/objects/neighbours.hpp"

namespace povslam {
namespace {

constexpr std::size_t kEnough = 5;
constexpr double kApart_m = 0.03;  // closer than that no view tells two things apart

// Nothing of fewer than enough.
std::optional<double> median(std::vector<double>& values) {
  if (values.size() < kEnough) return std::nullopt;
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::ranges::nth_element(values, middle);
  return *middle;
}

// How much further than it was seen an end may reach towards a neighbour that was seen gap_m beyond it. Less than
// nothing: views that told them apart showed a gap. Into it reaches neither, unless one lies within the other.
double may_reach(double gap_m, bool both) {
  constexpr double kMost_m = 0.08;
  if (gap_m >= kApart_m) return both ? 0.5 * (gap_m - kApart_m) : gap_m - kApart_m;
  const double back_m = 0.5 * (kApart_m - gap_m);
  return back_m > kMost_m ? 0.0 : -back_m;
}

// Moves its bottom there, unless little of it would be left.
void stand_at(double bottom_m, Box& box) {
  const double top_m = box.center.z() + 0.5 * box.size_m.z();
  if (top_m - bottom_m < 0.5 * box.size_m.z()) return;
  box.size_m.z() = top_m - bottom_m;
  box.center.z() = 0.5 * (top_m + bottom_m);
}

}  // namespace

// Of those whose ends were seen.
void ObjectLibrary::learn_extents() {
  struct Seen {
    std::vector<double> widths, heights;
  };
  std::map<std::uint16_t, Seen> seen;
  for (const auto& object : objects_) {
    const auto front = front_side(object->seen);
    if (object->phase != ObjectPhase::confirmed || !front) continue;
    Seen& of_class = seen[object->class_id()];
    const HiddenReach reach = object->hidden.reach(object->seen);
    if (reach.minus_m + reach.plus_m <= 0.0) of_class.widths.push_back(object->seen.box.size_m[front->along()]);
    if (reach.below_m <= 0.0) of_class.heights.push_back(object->seen.box.size_m.z());
  }
  for (auto& [id, all] : seen) {
    Extents& known = extents_[id];
    known.width_m = median(all.widths).value_or(known.width_m);
    known.height_m = median(all.heights).value_or(known.height_m);
  }
}

void ObjectLibrary::reshape(MapObject& object) const {
  refresh_shape(object, shape_weight(object), deepest_m(object));
  settle(object);
}

// Nearest neighbours beyond the ends of its front limit how far these may reach.
void ObjectLibrary::keep_apart(const MapObject& object, int along, std::array<double, 2>& reach_m) const {
  const double near_m = object.seen.box.size_m.norm() + kDeepest_m;
  for (const auto& other : objects_) {
    if (other.get() == &object || other->phase != ObjectPhase::confirmed || other->first_absent) continue;
    if (other->class_id() != object.class_id() || is_post(*other)) continue;
    if ((other->T_world_volume.translation - object.T_world_volume.translation).norm() > near_m) continue;
    const auto beyond = neighbour(object, *other, along);
    if (!beyond) continue;
    double& limit_m = reach_m[beyond->plus ? 1 : 0];
    limit_m = std::min(limit_m, may_reach(beyond->gap_m, other->hidden.any()));
  }
}

void ObjectLibrary::learn_rows() {
  row_members_.clear();
  for (const auto& object : objects_) {
    if (object->phase != ObjectPhase::confirmed || object->class_binds) continue;
    if (const auto member = row_member(*object)) row_members_.push_back(*member);
  }
}

Box ObjectLibrary::box_in_row(const MapObject& object, const RowHabits& row) const {
  HiddenReach hidden = object.hidden.reach(object.seen);
  std::array<double, 2> reach_m = {hidden.minus_m, hidden.plus_m};
  if (const auto front = front_side(object.seen)) keep_apart(object, front->along(), reach_m);
  hidden.minus_m = reach_m[0], hidden.plus_m = reach_m[1];
  SeenBox shown = grown(object.seen, hidden, row.width_m, row.height_m);
  const double origin_m = object.T_world_volume.translation.z();
  const double bottom_m = object.seen.box.center.z() - 0.5 * object.seen.box.size_m.z();
  if (const auto board_m = board_under(row.bottoms_m, origin_m + bottom_m, hidden.below_m))
    stand_at(*board_m - origin_m, shown.box);
  return row.depth_m > 0.0 ? with_known_depth(shown, row.depth_m) : with_depth(shown, deepest_m(object));
}

void ObjectLibrary::settle(MapObject& object) const {
  const auto front = front_side(object.seen);
  if (!front) return;
  const double deepest = deepest_m(object);
  const auto known = extents_.find(object.class_id());
  if (!object.class_binds) {  // a guessed class says nothing of how wide things are
    const RowHabits row = row_habits(object, row_members_);
    object.box = row.width_m > 0.0 ? box_in_row(object, row) : with_depth(object.seen, deepest);
    return;
  }
  if (known == extents_.end()) {
    object.box = with_depth(object.seen, deepest);
    return;
  }
  HiddenReach hidden = object.hidden.reach(object.seen);
  std::array<double, 2> reach_m = {hidden.minus_m, hidden.plus_m};
  keep_apart(object, front->along(), reach_m);
  hidden.minus_m = reach_m[0], hidden.plus_m = reach_m[1];
  object.box = with_depth(grown(object.seen, hidden, known->second.width_m, known->second.height_m), deepest);
}

}  // namespace povslam
