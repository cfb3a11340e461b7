// Turns what the threads count into Health and gives frames and health to the sinks, one call at a time: each frame
// on the publisher thread, health on the monitor thread once a period and at once when the state changed.
#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "daemon/sink.hpp"
#include "daemon/tracking_thread.hpp"

namespace povslam {

struct ReporterOptions {
  TimeNs health_period = kNsPerSecond;
  TimeNs tracking_limit = 3 * kNsPerSecond;  // working on one frame for longer, tracking counts as dead
  int num_sensors = 1;
};

class Reporter {
 public:
  Reporter(const ReporterOptions& options, std::vector<Sink*> sinks, PoseRing& poses, const Counters& counters);
  ~Reporter();  // closes the ring, gives out what is inside, reports health a last time, joins

  Reporter(const Reporter&) = delete;
  Reporter& operator=(const Reporter&) = delete;

  // Whose life the health speaks of; null: nobody's. Any thread.
  void watch(const TrackingThread* tracking);

 private:
  void publish_frames();
  void monitor(const std::stop_token& stop);
  void take(const TrackedFrame& frame);
  Health collect();

  ReporterOptions options_;
  std::vector<Sink*> sinks_;
  PoseRing& poses_;
  const Counters& counters_;
  TimeNs started_ = monotonic_now();

  std::mutex mutex_;  // all below, and the sinks
  std::condition_variable_any changed_;
  bool state_changed_ = false;
  const TrackingThread* tracking_ = nullptr;
  TrackState state_ = TrackState::initialising;
  MapSize map_;
  std::vector<float> latencies_ms_, tracking_ms_;  // of the period
  TimeNs period_began_ = started_;

  std::jthread monitor_;
  std::jthread publisher_;
};

}  // namespace povslam
