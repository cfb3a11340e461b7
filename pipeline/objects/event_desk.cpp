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
bool EventDesk::alike(const PlaceChange& gone, const PlaceChange& came) const {
  if (gone.named && came.named && gone.class_name != came.class_name) return false;
  const Eigen::Vector3d &a = gone.size_m, &b = came.size_m;
  const auto same = [this](double p, double q) { return alike_extent(p, q, options_); };
  return same(a.z(), b.z()) &&
         ((same(a.x(), b.x()) && same(a.y(), b.y())) || (same(a.x(), b.y()) && same(a.y(), b.x())));
}

// The most alike in looks; one whose coming was not noticed must be it without doubt.
std::vector<PlaceChange>::iterator EventDesk::origin_of(const PlaceChange& came, bool noticed) {
  auto best = gone_.end();
  double most = -1.0;
  for (auto from = gone_.begin(); from != gone_.end(); ++from) {
    if (!alike(*from, came)) continue;
    const double looks = likeness(from->appearance, came.appearance);
    const double distance_m = (from->place.position - came.place.position).norm();
    if (!noticed && (looks < options_.min_likeness || distance_m > options_.max_unnoticed_m ||
                     came.evidence.first_present <= from->evidence.last_present)) {
      continue;
    }
    constexpr double kPerMetre = 0.05;  // of two that look the same, the nearer
    if (looks - kPerMetre * distance_m > most) most = looks - kPerMetre * distance_m, best = from;
  }
  return best;
}

void EventDesk::pair_with_gone(std::vector<PlaceChange>& things, bool noticed, TimeNs now,
                               std::vector<ObjectEvent>& events) {
  for (auto to = things.begin(); to != things.end();) {
    const auto from = origin_of(*to, noticed);
    if (from == gone_.end()) {
      ++to;
      continue;
    }
    ObjectEvent event = make(ObjectEventType::moved, *to, now);
    event.object = from->object;
    if (!to->named) event.class_name = from->class_name;
    event.from = from->place;
    event.probability = from->probability * to->probability;
    if (from->evidence.first_absent) event.evidence.first_absent = from->evidence.first_absent;
    events.push_back(std::move(event));
    renamed_(to->object, from->object);
    gone_.erase(from);
    to = things.erase(to);
  }
}

void EventDesk::decide(TimeNs now, std::vector<ObjectEvent>& events) {
  pair_with_gone(came_, true, now, events);
  pair_with_gone(found_, false, now, events);
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
