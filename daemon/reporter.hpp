// Turns what the threads count into Health and gives frames, events, objects and health to the sinks, one call at a
// time: each frame and event on the publisher thread; on the monitor thread the list of objects once a period, and
// health once a period and at once when the state changed.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "daemon/report_rings.hpp"
#include "daemon/tracking_thread.hpp"

namespace povslam {

struct ReporterOptions {
  TimeNs health_period = kNsPerSecond;
  TimeNs objects_period = 2 * kNsPerSecond;
  TimeNs tracking_limit = 3 * kNsPerSecond;  // working on one frame for longer, tracking counts as dead
  int num_sensors = 1;
};

class Reporter {
 public:
  Reporter(const ReporterOptions& options, std::vector<Sink*> sinks, ReportRings& rings, const Counters& counters);
  ~Reporter();  // closes the rings, gives out what is inside, reports health a last time, joins

  Reporter(const Reporter&) = delete;
  Reporter& operator=(const Reporter&) = delete;

  // Whose life the health speaks of; null: nobody's. Any thread.
  void watch(const TrackingThread* tracking);

 private:
  void publish();
  void monitor(const std::stop_token& stop);
  void take(const TrackedFrame& frame);
  void take(WorldReport&& report);
  void report_health();
  void report_objects();
  Health collect();

  ReporterOptions options_;
  std::vector<Sink*> sinks_;
  ReportRings& rings_;
  const Counters& counters_;
  TimeNs started_ = monotonic_now();

  std::mutex mutex_;  // all below, and the sinks
  std::condition_variable_any changed_;
  bool state_changed_ = false;
  const TrackingThread* tracking_ = nullptr;
  TrackState state_ = TrackState::initialising;
  MapSize map_;
  VemCounts vem_;
  std::optional<ObjectSnapshot> objects_;                          // the newest; nothing: nobody understands
  UnderstandingNews news_;                                         // the last
  std::vector<float> latencies_ms_, tracking_ms_, understand_ms_;  // of the period
  TimeNs period_began_ = started_;

  std::jthread monitor_;
  std::jthread publisher_;
};

}  // namespace povslam
