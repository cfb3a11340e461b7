// The understanding thread: views and labels in; objects, dense map, events and owners of landmarks out. A view takes
// tens of milliseconds; what it is too slow for is dropped before it, with a count.
//
// An event is published once. With a store: when the change that holds it has come back from the disk, so that whoever
// hears of it finds it there after any crash; while the disk fails, events wait with everything else. Without a store:
// at once.
#pragma once

#include <algorithm>
#include <thread>

#include "daemon/change_rings.hpp"
#include "daemon/label_sources.hpp"
#include "daemon/thread_name.hpp"
#include "daemon/understanding_outlet.hpp"
#include "daemon/view_exchange.hpp"
#include "pipeline/base/log.hpp"

namespace povslam {

// How the thread is tied to the others. All outlive it.
struct UnderstandingLinks {
  Doorbell& bell;  // rung for views, labels and changes that come back
  ViewExchange& views;
  LabelRing& labels;                // of the sensor
  LabelSources* sources = nullptr;  // other processes; null: none
  OwnerRing& owners;
  BeliefRing& beliefs;
  ReportRing& reports;
  ChangeWay<WorldChange>* changes = nullptr;  // to the disk; null: nobody stores
};

// Mind: Understanding (pipeline/understanding.hpp), or a test's.
template <class Mind>
class BasicUnderstandingThread {
 public:
  // The mind is this thread's alone until finish().
  BasicUnderstandingThread(Mind& mind, const UnderstandingLinks& links)
      : mind_(mind), links_(links), outlet_(links.reports, links.owners, links.beliefs), thread_([this] { run(); }) {}
  ~BasicUnderstandingThread() { finish(); }

  BasicUnderstandingThread(const BasicUnderstandingThread&) = delete;
  BasicUnderstandingThread& operator=(const BasicUnderstandingThread&) = delete;

  // Once nobody hands over views or labels any more: understands what is there, ends the session, joins.
  void finish() {
    links_.views.close();
    if (thread_.joinable()) thread_.join();
  }

  // After finish(), with the store's thread ended: what is not stored yet, or null; give it back with stored().
  WorldChange* rest() {
    EXPECTS(!thread_.joinable());
    take_stored();
    return mind_.collect_change();
  }
  void stored(WorldChange* change) {
    outlet_.add(std::span<const ObjectEvent>(change->events));
    unstored_events_ -= std::min(unstored_events_, change->events.size());
    mind_.give_back(change);
    outlet_.flush();
  }

 private:
  void run();
  void take_in();
  void take_stored();
  void note(const Understood& done);
  void report(float total_ms);
  void note_naming();
  void hand_out_change();

  Mind& mind_;
  UnderstandingLinks links_;
  UnderstandingOutlet outlet_;
  UnderstandingNews news_;
  TimeNs last_stamp_ = 0;
  std::size_t unstored_events_ = 0;  // made, and not yet on the disk
  bool change_is_out_ = false;
  std::jthread thread_;  // last
};

template <class Mind>
void BasicUnderstandingThread<Mind>::run() {
  name_this_thread("understanding");
  report(-1.0F);
  for (bool last = false; !last;) {
    const std::uint32_t rung = links_.bell.count();
    last = links_.views.closed();
    take_in();
    for (; const Understood* done = mind_.step(); take_in()) note(*done);
    hand_out_change();
    outlet_.flush();
    if (!last) links_.bell.wait(rung);
  }
  mind_.stop_waiting();
  while (const Understood* done = mind_.step()) note(*done);
  note(mind_.finish());
  hand_out_change();
  outlet_.flush();
}

// Between any two steps: slots are few, and what waits in them makes tracking drop.
template <class Mind>
void BasicUnderstandingThread<Mind>::take_in() {
  while (const auto labels = links_.labels.try_pop()) mind_.add(*labels);
  while (const auto labels = links_.sources == nullptr ? std::nullopt : links_.sources->try_pop()) mind_.add(*labels);
  while (View* view = links_.views.try_take()) {
    if (links_.sources != nullptr) links_.sources->offer(view->frame);
    mind_.add(std::move(*view));
    links_.views.give_back();
  }
  take_stored();
}

template <class Mind>
void BasicUnderstandingThread<Mind>::take_stored() {
  if (links_.changes == nullptr) return;
  while (const auto change = links_.changes->stored.try_pop()) {
    change_is_out_ = false;
    stored(*change);
  }
}

template <class Mind>
void BasicUnderstandingThread<Mind>::note(const Understood& done) {
  const bool is_view = done.stamp > 0;
  if (is_view) last_stamp_ = done.stamp;
  news_.views_understood += is_view ? 1 : 0;
  news_.events += static_cast<std::int64_t>(done.events.size());
  if (done.times.asked) news_.naming_ms = done.times.name_ms;
  outlet_.add(std::span<const LandmarkOwner>(done.owners));
  outlet_.add(std::span<const ObjectBelief>(done.beliefs));
  if (links_.changes == nullptr) {
    outlet_.add(std::span<const ObjectEvent>(done.events));
  } else {
    unstored_events_ += done.events.size();
  }
  report(is_view ? done.times.total_ms : -1.0F);
  hand_out_change();
  outlet_.flush();
}

template <class Mind>
void BasicUnderstandingThread<Mind>::report(float total_ms) {
  ObjectSnapshot objects{last_stamp_, {}};
  for (const ObjectRecord& object : mind_.objects()) {
    if (object.phase == ObjectPhase::confirmed) objects.objects.push_back(object);
  }
  news_.objects = static_cast<int>(objects.objects.size());
  news_.labels = mind_.labels();
  if (links_.sources != nullptr) news_.label_sources = links_.sources->health();
  note_naming();
  news_.total_ms = total_ms;
  outlet_.send(news_);
  outlet_.send(std::move(objects));
}

template <class Mind>
void BasicUnderstandingThread<Mind>::note_naming() {
  const bool worked = news_.naming.failed == 0;
  news_.naming = mind_.naming();
  if (worked && news_.naming.failed > 0) {
    log::warn("labels: the network that names things failed, first with: {}; they go on without names",
              mind_.naming_error());
  }
}

// An event does not wait for the period of changes.
template <class Mind>
void BasicUnderstandingThread<Mind>::hand_out_change() {
  if (links_.changes == nullptr || change_is_out_) return;
  WorldChange* change = unstored_events_ > 0 ? mind_.collect_change() : mind_.take_change();
  if (change == nullptr) return;
  change_is_out_ = links_.changes->taken.try_push(std::move(change));
  EXPECTS(change_is_out_);  // given back unstored it would be forgotten; the ring holds more than can be out
}

using UnderstandingThread = BasicUnderstandingThread<Understanding>;

}  // namespace povslam
