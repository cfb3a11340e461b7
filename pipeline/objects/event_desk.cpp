#include "pipeline/objects/event_desk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "pipeline/objects/box_fit.hpp"
#include "pipeline/objects/object.hpp"

namespace povslam {
namespace {

// What is held for too long, oldest first.
template <class Told>
void tell_old(std::vector<PlaceChange>& held, TimeNs until, const Told& told) {
  const auto rest = std::stable_partition(held.begin(), held.end(),
                                          [until](const PlaceChange& change) { return change.decided <= until; });
  std::for_each(held.begin(), rest, told);
  held.erase(held.begin(), rest);
}

bool alike_extent(double a, double b, const EventDeskOptions& options) {
  const double low = std::min(a, b), high = std::max(a, b);
  return high - low <= options.max_size_difference_m || high <= options.max_size_ratio * low;
}

}  // namespace

EventDesk::EventDesk(const EventDeskOptions& options, std::int64_t next_seq,
                     std::function<void(std::int64_t, std::int64_t)> renamed)
    : options_(options), next_seq_(next_seq), renamed_(std::move(renamed)) {}

void EventDesk::gone(PlaceChange change) {
  gone_.push_back(std::move(change));
}
void EventDesk::came(PlaceChange change) {
  came_.push_back(std::move(change));
}
void EventDesk::found(PlaceChange change) {
  found_.push_back(std::move(change));
  constexpr std::size_t kRemembered = 256;
  if (found_.size() > kRemembered) found_.erase(found_.begin());
}
void EventDesk::refresh(PlaceChange change) {
  for (std::vector<PlaceChange>* things : {&came_, &found_}) {
    const auto known = std::ranges::find(*things, change.object, &PlaceChange::object);
    if (known == things->end()) continue;
    change.decided = known->decided;
    change.probability = known->probability;
    change.evidence.first_absent = known->evidence.first_absent;
    change.evidence.last_absent = known->evidence.last_absent;
    *known = std::move(change);
    return;
  }
}

std::vector<std::int64_t> EventDesk::waiting() const {
  std::vector<std::int64_t> ids;
  for (const std::vector<PlaceChange>* things : {&came_, &found_}) {
    for (const PlaceChange& change : *things) ids.push_back(change.object);
  }
  return ids;
}

void EventDesk::withdraw(std::int64_t object) {
  const auto is_it = [object](const PlaceChange& change) { return change.object == object; };
  std::erase_if(came_, is_it);
  std::erase_if(found_, is_it);
}

void EventDesk::correct(std::span<const KeyframeMotion> motions) {
  for (std::vector<PlaceChange>* changes : {&gone_, &came_, &found_}) {
    for (PlaceChange& change : *changes) {
      const Rigid3* T_new_old = motion_of(motions, change.keyframe);
      if (T_new_old == nullptr) continue;
      change.place.position = *T_new_old * change.place.position;
      change.place.yaw = fold_half_turn(change.place.yaw + yaw_of(*T_new_old));
    }
  }
}

bool EventDesk::holds_gone(std::int64_t object) const {
  return std::any_of(gone_.begin(), gone_.end(),
                     [object](const PlaceChange& change) { return change.object == object; });
}

ObjectEvent EventDesk::make(ObjectEventType type, const PlaceChange& change, TimeNs now) {
  ObjectEvent event;
  event.seq = next_seq_++;
  event.stamp = now;
  event.type = type;
  event.object = change.object;
  event.class_name = change.class_name;
  event.place = change.place;
  event.size_m = change.size_m;
  event.consistency = change.consistency;
  event.probability = change.probability;
  event.evidence = change.evidence;
  return event;
}

// A turned box has its two horizontal extents in either order.
EventDesk::Size EventDesk::compare(const PlaceChange& gone, const PlaceChange& came) const {
  if (gone.named && came.named && gone.class_name != came.class_name) return Size::another;
  const Eigen::Vector3d &a = gone.size_m, &b = came.size_m;
  const auto same = [this](double p, double q) { return alike_extent(p, q, options_); };
  const auto in_part = [&](double p, double q) {
    return same(p, q) || (p < q && !gone.whole) || (q < p && !came.whole);
  };
  const auto smaller = [&](double p, double q) { return same(p, q) || p < q; };
  const auto either_order = [&](const auto& equal) {
    return (equal(a.x(), b.x()) && equal(a.y(), b.y())) || (equal(a.x(), b.y()) && equal(a.y(), b.x()));
  };
  if (!same(a.z(), b.z())) return Size::another;
  if (either_order(same)) return Size::same;
  if (either_order(in_part)) return Size::seen_in_part;
  return either_order(smaller) ? Size::smaller : Size::another;
}

// How well the two go together, at least 0; below: not at all. What is near is paired at once, what is further off when
// one of the two cannot wait any longer.
double EventDesk::pairing(const PlaceChange& gone, const PlaceChange& came, bool noticed, TimeNs until) const {
  constexpr double kNot = -1.0, kPerMetre = 0.1, kOverlap = 0.15;
  const Size size = compare(gone, came);
  if (size == Size::another) return kNot;
  const bool known = is_known(gone.appearance) && is_known(came.appearance);
  const double looks = noticed && !known ? options_.min_likeness : likeness(gone.appearance, came.appearance);
  const double distance_m = (gone.place.position - came.place.position).norm();
  const bool near = distance_m <= options_.max_near_m, last_chance = gone.decided <= until;
  const bool beside = last_chance && distance_m <= options_.max_beside_m;
  if (size == Size::smaller && (!noticed || looks < options_.min_smaller_likeness)) return kNot;
  const bool sure = size == Size::same && (noticed || beside);
  if (looks < (sure ? options_.min_likeness : options_.min_unnoticed_likeness)) return kNot;
  if (noticed) {
    if (!near && !last_chance && came.decided > until) return kNot;
  } else {
    const Box from{gone.place.position, gone.size_m, gone.place.yaw},
        to{came.place.position, came.size_m, came.place.yaw};
    const bool apart = size != Size::same || overlap(from, to).of_smaller < kOverlap;
    const bool both_stood = came.evidence.first_present <= gone.evidence.last_present && apart;
    if (!near || both_stood) return kNot;
  }
  return 1.0 + looks - kPerMetre * std::min(distance_m, options_.max_near_m);
}

// Its first views show a side of it: the middle of that is decimetres from its own.
bool EventDesk::settled(const PlaceChange& came, TimeNs now) const {
  constexpr TimeNs kOutOfView = kNsPerSecond;
  return came.decided <= now - options_.settle || came.evidence.last_present < now - kOutOfView;
}

// The pair that goes together best becomes an event; false: there is none.
bool EventDesk::pair_best(TimeNs now, std::vector<ObjectEvent>& events) {
  struct Pair {
    double score = 0.0;
    std::vector<PlaceChange>::iterator gone, came;
    bool noticed = false;
  } best;
  const TimeNs until = now - options_.hold;
  for (const bool noticed : {true, false}) {
    std::vector<PlaceChange>& things = noticed ? came_ : found_;
    for (auto to = things.begin(); to != things.end(); ++to) {
      const bool waits = !settled(*to, now) && to->decided > until;
      for (auto from = gone_.begin(); from != gone_.end(); ++from) {
        if (waits && from->decided > until) continue;
        const double score = pairing(*from, *to, noticed, until);
        if (score > best.score) best = {score, from, to, noticed};
      }
    }
  }
  if (best.score <= 0.0) return false;
  ObjectEvent event = make(ObjectEventType::moved, *best.came, now);
  event.object = best.gone->object;
  if (!best.came->named) event.class_name = best.gone->class_name;
  event.from = best.gone->place;
  event.probability = best.gone->probability * best.came->probability;
  if (best.gone->evidence.first_absent) event.evidence.first_absent = best.gone->evidence.first_absent;
  events.push_back(std::move(event));
  renamed_(best.came->object, best.gone->object);
  gone_.erase(best.gone);
  (best.noticed ? came_ : found_).erase(best.came);
  return true;
}

void EventDesk::decide(TimeNs now, std::vector<ObjectEvent>& events) {
  while (pair_best(now, events)) continue;
  const TimeNs until = now - options_.hold;
  tell_old(gone_, until, [&](const PlaceChange& c) { events.push_back(make(ObjectEventType::removed, c, now)); });
  tell_old(came_, until, [&](const PlaceChange& c) { events.push_back(make(ObjectEventType::appeared, c, now)); });
}

void EventDesk::decide_all(TimeNs now, std::vector<ObjectEvent>& events) {
  decide(now, events);
  decide(std::numeric_limits<TimeNs>::max(), events);
  for (ObjectEvent& event : events) event.stamp = std::min(event.stamp, now);
}

}  // namespace povslam
