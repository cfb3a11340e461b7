// What `povslam listen` does with each message: shows it, keeps its pose, and measures how old it is on arrival.
#pragma once

#include <bot_core/pose_t.hpp>
#include <povslam/health_t.hpp>
#include <povslam/object_event_t.hpp>
#include <povslam/object_list_t.hpp>
#include <povslam/pose_t.hpp>
#include <string>
#include <vector>

#include "drivers/replay/trajectory_file.hpp"
#include "tools/povslam/object_snapshots.hpp"

namespace povslam {

struct ListenOptions {
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
  std::string channel;     // shown; empty: poses, events, health, and how many objects there are when that changes
  double rate_hz = 5.0;    // poses shown
  std::size_t count = 0;   // 0: until told to stop
  double timeout_s = 0.0;  // 0: wait for ever
  std::string out;
  Rigid3 T_body_tracked;  // what --out follows: the body itself or its camera
};

class Listener {
 public:
  explicit Listener(const ListenOptions& options);

  void on_pose(const pose_t& message);
  void on_bot_core_pose(const bot_core::pose_t& message);
  void on_health(const health_t& message);
  void on_event(const object_event_t& message);
  void on_objects(const object_list_t& message);

  // Prints latencies and writes --out. "From frame to here" adds what the wall clock says passed since the hand-over:
  // true on the daemon's machine, and elsewhere as far as the clocks agree.
  Status finish() const;
  std::size_t poses() const { return poses_; }

 private:
  bool shows(const char* channel) const;
  bool due(TimeNs& last_shown) const;

  ListenOptions options_;
  std::size_t poses_ = 0;
  std::int64_t next_event_ = -1;  // expected; -1: any
  std::int64_t event_session_ = 0;
  ObjectSnapshots snapshots_;
  std::size_t num_objects_ = 0;
  int state_ = -1;
  TimeNs pose_shown_ = 0, bot_core_shown_ = 0;
  std::vector<double> latency_ms_, receipt_ms_;
  std::vector<StampedPose> trajectory_;
};

}  // namespace povslam
