#include "daemon/tracking_thread.hpp"

#include "daemon/thread_name.hpp"

namespace povslam {

TrackingThread::TrackingThread(Pipeline& pipeline, FrameExchange& frames, PoseRing& poses, JobRing& asked,
                               JobRing& solved, ChangeWay<MapChange>* changes, Counters& counters, TrackingProbe probe)
    : pipeline_(pipeline),
      frames_(frames),
      poses_(poses),
      asked_(asked),
      solved_(solved),
      changes_(changes),
      counters_(counters),
      probe_(probe),
      thread_([this] { run(); }) {}

TrackingThread::~TrackingThread() {
  frames_.close();
  thread_.join();
}

void TrackingThread::run() {
  name_this_thread("tracking");
  while (const SensorFrame* frame = frames_.take()) {
    busy_since_.store(monotonic_now(), std::memory_order_relaxed);
    if (probe_.frame_taken != nullptr) probe_.frame_taken();
    localise(*frame);
    if (probe_.pose_handed_over != nullptr) probe_.pose_handed_over();
    frames_.give_back();
    ask_backend();
    hand_out_change();
    counters_.tracking_cpu.store(thread_cpu_now(), std::memory_order_relaxed);
    busy_since_.store(0, std::memory_order_relaxed);
  }
}

void TrackingThread::localise(const SensorFrame& frame) {
  while (const auto job = solved_.try_pop()) pipeline_.give_back(*job);
  out_.pose = pipeline_.localise(frame.rgbd);
  out_.map = pipeline_.map_size();
  out_.received = frame.received;
  const bool has_pose = out_.pose.state == TrackState::ok || out_.pose.state == TrackState::degraded;
  (has_pose ? counters_.tracked : counters_.lost).fetch_add(1, std::memory_order_relaxed);
  out_.handed_over = monotonic_now();
  if (!poses_.try_push(TrackedFrame(out_))) counters_.drop(DropReason::publisher);
}

void TrackingThread::ask_backend() {
  while (const auto job = pipeline_.take_job()) {
    if (!asked_.try_push(BackendJob(*job))) pipeline_.give_back(*job);
  }
}

void TrackingThread::hand_out_change() {
  if (changes_ == nullptr) return;
  while (const auto stored = changes_->stored.try_pop()) pipeline_.give_back(*stored);
  MapChange* change = pipeline_.take_change();
  if (change == nullptr) return;
  const bool taken = changes_->taken.try_push(std::move(change));
  EXPECTS(taken);  // given back unstored it would be forgotten; the ring holds as many as can be out at once
}

bool TrackingThread::alive(TimeNs limit) const {
  const TimeNs now = monotonic_now();
  const TimeNs busy_since = busy_since_.load(std::memory_order_relaxed);
  if (busy_since != 0 || !frames_.waiting()) {
    waking_since_.store(0, std::memory_order_relaxed);
    return busy_since == 0 || now - busy_since <= limit;
  }
  TimeNs since = 0;
  waking_since_.compare_exchange_strong(since, now, std::memory_order_relaxed);
  return since == 0 || now - since <= limit;
}

}  // namespace povslam
