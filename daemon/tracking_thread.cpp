#include "daemon/tracking_thread.hpp"

#include "daemon/thread_name.hpp"

namespace povslam {

TrackingThread::TrackingThread(Pipeline& pipeline, const TrackingLinks& links, Counters& counters, TrackingProbe probe)
    : pipeline_(pipeline), links_(links), counters_(counters), probe_(probe), thread_([this] { run(); }) {}

TrackingThread::~TrackingThread() {
  links_.frames.close();
  thread_.join();
}

void TrackingThread::run() {
  name_this_thread("tracking");
  while (const SensorFrame* frame = links_.frames.take()) {
    busy_since_.store(monotonic_now(), std::memory_order_relaxed);
    if (probe_.frame_taken != nullptr) probe_.frame_taken();
    localise(*frame);
    if (probe_.pose_handed_over != nullptr) probe_.pose_handed_over();
    hand_out_view(frame->rgbd);
    links_.frames.give_back();
    ask_backend();
    hand_out_change();
    take_owners();
    take_beliefs();
    counters_.tracking_cpu.store(thread_cpu_now(), std::memory_order_relaxed);
    busy_since_.store(0, std::memory_order_relaxed);
  }
}

void TrackingThread::localise(const SensorFrame& frame) {
  while (const auto job = links_.solved.try_pop()) pipeline_.give_back(*job);
  while (const auto window = links_.windows_solved == nullptr ? std::nullopt : links_.windows_solved->try_pop()) {
    pipeline_.give_back(*window);
  }
  out_.pose = pipeline_.localise(frame.rgbd);
  out_.map = pipeline_.map_size();
  out_.vem = pipeline_.vem();
  out_.received = frame.received;
  const bool has_pose = out_.pose.state == TrackState::ok || out_.pose.state == TrackState::degraded;
  (has_pose ? counters_.tracked : counters_.lost).fetch_add(1, std::memory_order_relaxed);
  out_.handed_over = monotonic_now();
  if (!links_.poses.try_push(TrackedFrame(out_))) counters_.drop(DropReason::publisher);
}

void TrackingThread::ask_backend() {
  while (const auto job = pipeline_.take_job()) {
    const bool window = std::holds_alternative<VemProblem*>(*job) && links_.windows != nullptr;
    if (!(window ? *links_.windows : links_.asked).try_push(BackendJob(*job))) pipeline_.give_back(*job);
  }
}

void TrackingThread::hand_out_change() {
  if (links_.changes == nullptr) return;
  while (const auto stored = links_.changes->stored.try_pop()) pipeline_.give_back(*stored);
  MapChange* change = pipeline_.take_change();
  if (change == nullptr) return;
  const bool taken = links_.changes->taken.try_push(std::move(change));
  EXPECTS(taken);  // given back unstored it would be forgotten; the ring holds as many as can be out at once
}

// After the pose has left. The view is a copy: the frame's slot goes back to the sensor.
void TrackingThread::hand_out_view(const RgbdFrame& frame) {
  if (links_.views == nullptr || !pipeline_.view_due()) return;
  View* view = links_.views->draft();
  if (view == nullptr) {
    counters_.views_dropped.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  pipeline_.fill_view(frame, *view);
  links_.views->submit();
  counters_.views.fetch_add(1, std::memory_order_relaxed);
}

void TrackingThread::take_owners() {
  if (links_.owners == nullptr) return;
  std::size_t count = 0;
  while (count < owners_.size()) {
    const auto owner = links_.owners->try_pop();
    if (!owner) break;
    owners_[count++] = *owner;
  }
  if (count > 0) pipeline_.take_owners(std::span(owners_).first(count));
}

void TrackingThread::take_beliefs() {
  if (links_.beliefs == nullptr) return;
  std::size_t count = 0;
  while (count < beliefs_.size()) {
    const auto belief = links_.beliefs->try_pop();
    if (!belief) break;
    beliefs_[count++] = *belief;
  }
  if (count > 0) pipeline_.take_beliefs(std::span(beliefs_).first(count));
}

bool TrackingThread::alive(TimeNs limit) const {
  const TimeNs now = monotonic_now();
  const TimeNs busy_since = busy_since_.load(std::memory_order_relaxed);
  if (busy_since != 0 || !links_.frames.waiting()) {
    waking_since_.store(0, std::memory_order_relaxed);
    return busy_since == 0 || now - busy_since <= limit;
  }
  TimeNs since = 0;
  waking_since_.compare_exchange_strong(since, now, std::memory_order_relaxed);
  return since == 0 || now - since <= limit;
}

}  // namespace povslam
