// What the understanding thread drives, in place of Understanding: of each view an object and, if told, an event.
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <thread>
#include <vector>

#include "pipeline/understanding.hpp"

namespace povslam {

class FakeMind {
 public:
  std::atomic<int> slowness_ms{0};           // of a step
  std::atomic<bool> wait_for_labels{false};  // views stay until labels of their stamp came or waiting ends
  int events_each = 1, events_at_end = 1;
  std::atomic<int> views{0}, labels_added{0}, given_back{0}, changes_out{0};
  std::vector<const std::uint8_t*> buffers;  // of the views as they came

  void add(View&& view) {
    ++views;
    buffers.push_back(view.frame.color.data());
    waiting_.push_back(view.stamp());
    std::swap(view.frame.color, spare_);  // buffers of an earlier one, at first none
  }
  void add(const LabelFrame& labels) {
    ++labels_added;
    ++counts_.received;
    labelled_ = std::max(labelled_, labels.stamp);
  }
  const Understood* step() {
    if (waiting_.empty() || (wait_for_labels && !stopped_ && waiting_.front() > labelled_)) return nullptr;
    std::this_thread::sleep_for(std::chrono::milliseconds(slowness_ms));
    done_ = {};
    done_.stamp = waiting_.front();
    waiting_.pop_front();
    done_.times.total_ms = 25.0F;
    make_events(events_each);
    done_.owners = {{static_cast<std::int64_t>(objects_.size()), 0, 7}};
    objects_.emplace_back();
    objects_.back().phase = objects_.size() % 2 == 1 ? ObjectPhase::confirmed : ObjectPhase::tentative;
    return &done_;
  }
  void stop_waiting() { stopped_ = true; }
  const Understood& finish() {
    done_ = {};
    make_events(events_at_end);
    return done_;
  }
  const std::vector<ObjectRecord>& objects() const { return objects_; }
  const LabelCounts& labels() const { return counts_; }
  std::atomic<int> names_failed{0};
  NamingCounts naming() const { return {views, names_failed, 0}; }
  std::string naming_error() const { return "out of memory"; }

  WorldChange* take_change() { return nullptr; }  // too little time has passed
  WorldChange* collect_change() {
    if (out_ || unstored_.empty()) return nullptr;
    out_ = true;
    ++changes_out;
    change_.clear();
    change_.events.swap(unstored_);
    change_.meta.next_event_seq = next_seq_;
    change_.meta.next_object = 1;
    return &change_;
  }
  void give_back(WorldChange*) {
    out_ = false;
    ++given_back;
  }

 private:
  void make_events(int count) {
    for (int i = 0; i < count; ++i) {
      ObjectEvent event;
      event.seq = next_seq_++;
      event.stamp = done_.stamp;
      event.object = 0;
      done_.events.push_back(event);
      unstored_.push_back(event);
    }
  }

  std::deque<TimeNs> waiting_;
  ImageU8 spare_;
  Understood done_;
  std::vector<ObjectRecord> objects_;
  LabelCounts counts_;
  TimeNs labelled_ = 0;
  bool stopped_ = false, out_ = false;
  std::int64_t next_seq_ = 0;
  WorldChange change_;
  std::vector<ObjectEvent> unstored_;
};

}  // namespace povslam
