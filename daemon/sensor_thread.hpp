// One sensor: reads its driver and hands frames to tracking. A driver that fails is closed and reopened with growing
// pauses; the rest of the daemon goes on meanwhile. Every frame that does not reach tracking is counted with a reason.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "daemon/counters.hpp"
#include "daemon/frame_exchange.hpp"
#include "daemon/label_ring.hpp"
#include "drivers/driver.hpp"
#include "drivers/gap_counter.hpp"

namespace povslam {

struct SensorThreadOptions {
  std::string name;
  TimeNs first_pause = 100 * kNsPerMs;  // before reopening; doubles up to
  TimeNs longest_pause = 5 * kNsPerSecond;
};

class SensorThread {
 public:
  // `driver` is open, `setup` what open() said. labels: for what the driver says of the camera's images; null: unused.
  // `on_end` is called once, on the sensor thread, when the stream is over.
  SensorThread(SensorThreadOptions options, std::unique_ptr<Driver> driver, DriverSetup setup, FrameExchange& frames,
               LabelRing* labels, Counters& counters, std::function<void()> on_end);
  ~SensorThread();  // stops, joins, closes the driver

  SensorThread(const SensorThread&) = delete;
  SensorThread& operator=(const SensorThread&) = delete;

 private:
  void run(const std::stop_token& stop);
  bool accept(SensorFrame& frame);
  void hand_over_labels(SensorFrame& frame);
  void submit();
  bool reopen(const std::stop_token& stop, const std::string& why);
  bool try_open(std::string& why);
  void pause(const std::stop_token& stop, TimeNs duration);

  SensorThreadOptions options_;
  std::unique_ptr<Driver> driver_;
  DriverSetup setup_;
  FrameExchange& frames_;
  LabelRing* labels_;
  Counters& counters_;
  std::function<void()> on_end_;

  TimeNs last_stamp_;
  GapCounter gaps_;

  std::mutex pause_mutex_;
  std::condition_variable_any pause_;
  std::jthread thread_;  // last: stops before what it uses goes
};

}  // namespace povslam
