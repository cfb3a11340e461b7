// From what went and what came to events: a thing that went here and came there moved. Each change is told once.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pipeline/objects/appearance.hpp"
#include "pipeline/objects/keyframe_motion.hpp"
#include "pipeline/objects/object_event.hpp"

namespace povslam {

struct PlaceChange {  // a thing went from a place, or came to one
  std::int64_t object = -1;
  std::string class_name;
  bool named = true;  // false: the class says nothing; it may be of any other
  ObjectPlace place;
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
  bool whole = true;  // false: two sides that meet were not seen, so that it is so long and so wide at least
  double consistency = 0.0;
  double probability = 0.0;
  Evidence evidence;
  Appearance appearance;
  TimeNs decided = 0;
  std::int64_t keyframe = -1;  // that the place hangs on; -1: on none
};

struct EventDeskOptions {
  TimeNs hold = 8 * kNsPerSecond;       // an event waits so long for its other half
  double max_size_ratio = 1.35;         // between two looks at one thing, each extent…
  double min_likeness = 0.3;            // of their looks, where both are known
  double max_near_m = 3.0;              // what moved further is paired only when nothing nearer came up in the meantime
  double min_unnoticed_likeness = 0.5;  // of the looks of a thing that went and one whose coming was not noticed…
  double max_beside_m = 1.5;            // …or min_likeness, when nothing better came up: it stands no further off
  double min_smaller_likeness = 0.75;   // of a thing that went and looked smaller: others hid a part of it
  double max_size_difference_m = 0.15;  // …or this much
};

class EventDesk {
 public:
  // next_seq: of the first event. renamed(came, gone): the thing that came is known by its old id from now on.
  EventDesk(const EventDeskOptions& options, std::int64_t next_seq,
            std::function<void(std::int64_t came, std::int64_t gone)> renamed);

  void gone(PlaceChange change);
  void came(PlaceChange change);
  // A thing whose place had not been seen before: it came if it is one that went, else it was always there.
  void found(PlaceChange change);
  // What is known by now of a thing that came or was found and waits here; its times and evidence stay.
  void refresh(PlaceChange change);
  std::vector<std::int64_t> waiting() const;  // things that came or were found
  bool any_gone() const { return !gone_.empty(); }
  // A thing that was to come is none after all.
  void withdraw(std::int64_t object);
  // Places that hang on keyframes that were moved move along.
  void correct(std::span<const KeyframeMotion> motions);
  // Appends what is decided by now, in order of decision.
  void decide(TimeNs now, std::vector<ObjectEvent>& events);
  void decide_all(TimeNs now, std::vector<ObjectEvent>& events);
  std::int64_t next_seq() const { return next_seq_; }
  void continue_at(std::int64_t next_seq) { next_seq_ = next_seq; }
  bool holds_gone(std::int64_t object) const;

 private:
  ObjectEvent make(ObjectEventType type, const PlaceChange& change, TimeNs now);
  enum class Size : std::uint8_t { same, seen_in_part, smaller, another };
  Size compare(const PlaceChange& gone, const PlaceChange& came) const;
  double pairing(const PlaceChange& gone, const PlaceChange& came, bool noticed, TimeNs until) const;
  bool pair_best(TimeNs now, std::vector<ObjectEvent>& events);

  EventDeskOptions options_;
  std::int64_t next_seq_;
  std::function<void(std::int64_t, std::int64_t)> renamed_;
  std::vector<PlaceChange> gone_, came_, found_;
};

}  // namespace povslam
