// The tracking thread: frame in, pose out. Between taking a frame and handing its pose over it calls the pipeline and
// nothing else: no log, no LCM, no lock of ours, and once warm no allocation.
#pragma once

#include <array>
#include <atomic>
#include <thread>

#include "daemon/change_rings.hpp"
#include "daemon/counters.hpp"
#include "daemon/frame_exchange.hpp"
#include "daemon/report_rings.hpp"
#include "daemon/understanding_outlet.hpp"
#include "daemon/view_exchange.hpp"
#include "pipeline/pipeline.hpp"

namespace povslam {

// Called on the tracking thread around the path that must neither allocate nor lock; for tests that count.
struct TrackingProbe {
  void (*frame_taken)() = nullptr;
  void (*pose_handed_over)() = nullptr;
};

using JobRing = SpscRing<BackendJob>;

// How the thread is tied to the others. All outlive it.
struct TrackingLinks {
  FrameExchange& frames;
  PoseRing& poses;
  JobRing& asked;                           // jobs to solve
  JobRing& solved;                          // the answers
  ChangeWay<MapChange>* changes = nullptr;  // of the map, to the disk; null: nobody stores it
  ViewExchange* views = nullptr;            // frames to be understood…
  OwnerRing* owners = nullptr;              // …and what came of it…
  BeliefRing* beliefs = nullptr;            // …all null: nobody understands
  JobRing* windows = nullptr;               // of variational EM, to solve…
  JobRing* windows_solved = nullptr;        // …and the answers
};

class TrackingThread {
 public:
  // The pipeline is this thread's alone until it is destroyed.
  TrackingThread(Pipeline& pipeline, const TrackingLinks& links, Counters& counters, TrackingProbe probe);
  ~TrackingThread();  // closes the exchange, tracks what is inside, joins

  TrackingThread(const TrackingThread&) = delete;
  TrackingThread& operator=(const TrackingThread&) = delete;

  // Any thread. True when the loop answers: it works on a frame for no longer than `limit`, or it waits and nothing is
  // there to be taken. A camera that is silent thus does not make tracking look dead.
  bool alive(TimeNs limit) const;

 private:
  void run();
  void localise(const SensorFrame& frame);
  void ask_backend();
  void hand_out_change();
  void hand_out_view(const RgbdFrame& frame);
  void take_owners();
  void take_beliefs();

  Pipeline& pipeline_;
  TrackingLinks links_;
  Counters& counters_;
  TrackingProbe probe_;
  TrackedFrame out_;
  std::array<LandmarkOwner, 2048> owners_;       // of one turn: more wait for the next
  std::array<ObjectBelief, 64> beliefs_;         // likewise
  std::atomic<TimeNs> busy_since_{0};            // monotonic; 0: waiting for a frame
  mutable std::atomic<TimeNs> waking_since_{0};  // monotonic; since when it has been seen waiting beside a frame
  std::jthread thread_;
};

}  // namespace povslam
