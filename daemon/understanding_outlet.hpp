// What leaves the understanding thread: events, the list of objects and figures to the reporter, owners of landmarks
// and what is believed of objects to tracking. Nothing here waits; what finds no room is kept (events, owners, beliefs)
// or left out (what a newer one replaces).
#pragma once

#include <deque>
#include <span>

#include "daemon/world_report.hpp"

namespace povslam {

using OwnerRing = SpscRing<LandmarkOwner>;
using BeliefRing = SpscRing<ObjectBelief>;

class UnderstandingOutlet {
 public:
  UnderstandingOutlet(ReportRing& reports, OwnerRing& owners, BeliefRing& beliefs)
      : reports_(reports), owners_(owners), beliefs_(beliefs) {}

  void add(std::span<const ObjectEvent> events) { events_.insert(events_.end(), events.begin(), events.end()); }
  void add(std::span<const LandmarkOwner> owners) {
    unsent_owners_.insert(unsent_owners_.end(), owners.begin(), owners.end());
  }
  void add(std::span<const ObjectBelief> beliefs) {
    unsent_beliefs_.insert(unsent_beliefs_.end(), beliefs.begin(), beliefs.end());
  }
  void send(const UnderstandingNews& news) { reports_.try_push(WorldReport(news)); }
  void send(ObjectSnapshot&& objects) { reports_.try_push(WorldReport(std::move(objects))); }
  void flush();  // what is kept, as far as there is room
  std::size_t unsent_events() const { return events_.size(); }

 private:
  ReportRing& reports_;
  OwnerRing& owners_;
  BeliefRing& beliefs_;
  std::deque<ObjectEvent> events_;
  std::deque<LandmarkOwner> unsent_owners_;
  std::deque<ObjectBelief> unsent_beliefs_;
};

}  // namespace povslam
