// What leaves the daemon and who takes it: LCM, systemd, the log, `replay --realtime`, tests.
#pragma once

#include <array>
#include <cstdint>

#include "daemon/counters.hpp"
#include "daemon/world_report.hpp"
#include "pipeline/output.hpp"
#include "pipeline/vem_counts.hpp"

namespace povslam {

struct TrackedFrame {
  PoseEstimate pose;
  MapSize map;
  VemCounts vem;
  TimeNs received = 0;     // monotonic: the driver had the frame whole
  TimeNs handed_over = 0;  // monotonic: the pose left the tracking thread
};

struct Percentiles {
  double p50 = 0.0, p99 = 0.0;
};

enum class StoreState : std::uint8_t { none, ok, began_empty, failing };  // see health_t.lcm

struct StoreHealth {
  StoreState state = StoreState::none;
  std::int64_t commits = 0;
  double commit_age_s = -1.0;  // since the last one; < 0: none yet
  double commit_last_ms = 0.0;
};

struct UnderstandingHealth {  // all 0 while it is off
  std::int64_t views = 0, views_dropped = 0;
  std::int64_t labels_dropped = 0;
  UnderstandingNews news;  // the last
  Percentiles view_ms;     // CPU a view, of the period since the report before
};

struct Health {
  TrackState state = TrackState::initialising;  // of the last frame
  bool tracking_alive = true;
  int sensors_up = 0, sensors_down = 0;
  std::int64_t reopened = 0;
  std::int64_t frames_in = 0, frames_tracked = 0, frames_lost = 0;
  std::array<std::int64_t, kNumDropReasons> drops{};  // by DropReason
  double uptime_s = 0.0;
  double frames_per_s = 0.0;  // this and the next two: of the period since the report before
  Percentiles latency_ms;     // frame received to pose handed over
  Percentiles tracking_ms;    // CPU of the tracking thread a frame
  MapSize map;
  std::int64_t backend_runs = 0;
  double backend_last_ms = 0.0;
  std::int64_t vem_runs = 0;
  double vem_last_ms = 0.0;
  VemCounts vem;
  StoreHealth store;
  UnderstandingHealth understanding;
  double memory_rss_mb = 0.0;
};

// The state as the robot's operator should see it: tracking's, but no better than degraded while the map on disk needs
// somebody.
TrackState overall_state(const Health& health);

// Calls come one at a time, never from the tracking thread.
class Sink {
 public:
  virtual ~Sink() = default;
  virtual void on_frame(const TrackedFrame& /*frame*/) {}
  virtual void on_health(const Health& /*health*/) {}
  virtual void on_event(const ObjectEvent& /*event*/) {}
  virtual void on_objects(const ObjectSnapshot& /*objects*/) {}  // all that stand, again and again
};

}  // namespace povslam
