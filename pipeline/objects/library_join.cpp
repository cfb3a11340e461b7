// Two objects that are one thing: one observation showed both, or something nearer hides the middle in each view.
#include <algorithm>
#include <cmath>

#include "pipeline/objects/halves.hpp"
#include "pipeline/objects/library.hpp"
#include "pipeline/objects/merge.hpp"
#include "pipeline/objects/neighbours.hpp"

namespace povslam {
namespace {

constexpr std::size_t kEnough = 10;
constexpr double kMost = 0.9;

// One thing twice; the one that shows less of it.
bool is_double_of(const MapObject& part, const MapObject& whole) {
  constexpr double kSame = 0.6;
  const std::pair of_part(part.surface.size(), -part.id), of_whole(whole.surface.size(), -whole.id);
  return !part.class_binds && of_part < of_whole && overlap(part.box_world(), whole.box_world()).iou > kSame;
}

// Much smaller, and most of its surface within the other's box.
bool is_fragment_of(const MapObject& part, const MapObject& whole) {
  constexpr double kGrow_m = 0.05, kSmaller = 0.5, kWithin = 0.6;
  if (static_cast<double>(part.surface.size()) > kSmaller * static_cast<double>(whole.surface.size())) return false;
  const Rigid3 T_whole_part = whole.T_world_volume.inverse() * part.T_world_volume;
  const auto inside = std::ranges::count_if(part.surface, [&](const SurfacePoint& point) {
    return whole.box.contains(T_whole_part * point.p_volume.cast<double>(), kGrow_m);
  });
  return static_cast<double>(inside) > kWithin * static_cast<double>(part.surface.size());
}

}  // namespace

// How wide things of its class, or its row, are wont to be, where enough of them are known; else nothing is.
double ObjectLibrary::widest_m(const MapObject& object) const {
  if (!object.class_binds) return row_habits(object, row_members_).widest_m;
  std::vector<double> widths;
  for (const auto& other : objects_) {
    if (other->phase != ObjectPhase::confirmed || other->class_id() != object.class_id()) continue;
    widths.push_back(other->seen.box.size_m.head<2>().maxCoeff());
  }
  if (widths.size() < kEnough) return 0.0;
  const auto most = widths.begin() + std::lround(kMost * static_cast<double>(widths.size() - 1));
  std::ranges::nth_element(widths, most);
  return *most;
}

void ObjectLibrary::merge_duplicates(const Association& association, const std::vector<MapObject*>& reach,
                                     LibraryStep& step) {
  std::vector<std::int64_t> merged, heirs;
  const auto alive = [this](const MapObject* object) {
    return std::ranges::any_of(objects_, [object](const auto& kept) { return kept.get() == object; });
  };
  for (const auto& [i, j] : association.one_seen_as) {
    MapObject *a = reach[static_cast<std::size_t>(i)], *b = reach[static_cast<std::size_t>(j)];
    if (!alive(a) || !alive(b)) continue;
    if (b->first_seen < a->first_seen) std::swap(a, b);
    const bool gone = std::ranges::count(merged, a->id) + std::ranges::count(merged, b->id) > 0;
    const bool young = b->phase == ObjectPhase::tentative;
    if (gone || fenced_apart(*a, *b) ||
        (!young && overlap(a->box_world(), b->box_world()).of_smaller < options_.life.merge_overlap))
      continue;
    merge_into(*a, *b);
    reshape(*a);
    merged.push_back(b->id);
    heirs.push_back(a->id);
  }
  for (std::size_t i = 0; i < merged.size(); ++i) {
    desk_.withdraw(merged[i]);
    erase(merged[i], heirs[i], step);
  }
}

// As an observation that lies within a thing begins no object, so an object that does is none: a side of the thing
// that was seen before the thing was known to reach there.
void ObjectLibrary::absorb_fragments(TimeNs now, LibraryStep& step) {
  std::vector<MapObject*> seen;
  for (const auto& object : objects_) {
    const bool here = object->phase == ObjectPhase::confirmed && object->last_seen == now;
    if (here) seen.push_back(object.get());
  }
  std::vector<std::pair<std::int64_t, std::int64_t>> absorbed;  // from, into
  for (const MapObject* part : seen) {
    const auto whole = std::ranges::find_if(seen, [part](const MapObject* other) {
      return other != part && other->class_id() == part->class_id() &&
             (is_fragment_of(*part, *other) || is_double_of(*part, *other));
    });
    if (whole != seen.end()) absorbed.emplace_back(part->id, (*whole)->id);
  }
  for (const auto& [from, into] : absorbed) {
    desk_.withdraw(from);
    erase(from, into, step);
  }
}

void ObjectLibrary::join_halves(const Association& association, const std::vector<MapObject*>& reach,
                                const DepthView& view, LibraryStep& step) {
  constexpr int kViews = 3;
  std::vector<MapObject*> seen;  // that are still there: some were merged in this view
  for (const Match& match : association.matches) {
    MapObject* object = reach[static_cast<std::size_t>(match.object)];
    const bool kept = std::ranges::any_of(objects_, [object](const auto& known) { return known.get() == object; });
    if (kept && !class_of(*object).one_piece && !object->first_absent) seen.push_back(object);
  }
  std::vector<std::pair<std::int64_t, std::int64_t>> joined;  // from, into
  const auto is_joined = [&](const MapObject* object) {
    return std::ranges::any_of(joined, [object](const auto& pair) { return pair.first == object->id; });
  };
  for (std::size_t i = 0; i < seen.size(); ++i) {
    for (std::size_t j = i + 1; j < seen.size(); ++j) {
      MapObject *into = seen[i], *from = seen[j];
      if (is_joined(into) || is_joined(from) || !are_halves(*into, *from, view, kViews)) continue;
      if (into->phase == ObjectPhase::tentative || (from->phase == into->phase && from->id < into->id)) {
        std::swap(into, from);
      }
      const double least_looks = std::min(into->looks, from->looks);
      merge_into(*into, *from);
      into->looks = least_looks;  // at any of its surface: each half had its own
      reshape(*into);
      joined.emplace_back(from->id, into->id);
    }
  }
  for (const auto& [from, into] : joined) {
    desk_.withdraw(from);
    erase(from, into, step);
  }
}

bool ObjectLibrary::are_halves(const MapObject& a, const MapObject& b, const DepthView& view, int views) {
  constexpr double kNear_m = 1.0;
  const bool tentative = a.phase == ObjectPhase::tentative && b.phase == ObjectPhase::tentative;
  if (tentative || a.class_id() != b.class_id() || fenced_apart(a, b)) return false;
  if ((a.box_world().center - b.box_world().center).norm() > kNear_m) return false;
  if (!may_be_halves(a, b, widest_m(a))) return false;
  if (hidden_between(a, b) || hidden_between(b, a)) return true;
  int& hidden = halves_[std::minmax(a.id, b.id)];
  const Between between = look_between(a, b, view);
  if (between == Between::hidden) ++hidden;
  if (between == Between::open) hidden = -views;
  return hidden >= views;
}

}  // namespace povslam
