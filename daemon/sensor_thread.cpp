#include "daemon/sensor_thread.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "daemon/thread_name.hpp"
#include "pipeline/base/log.hpp"

namespace povslam {
namespace {

bool same_camera(const SensorCalibration& a, const SensorCalibration& b) {
  return a.kind == b.kind && a.camera.width == b.camera.width && a.camera.height == b.camera.height &&
         a.camera.fx == b.camera.fx && a.camera.fy == b.camera.fy && a.camera.cx == b.camera.cx &&
         a.camera.cy == b.camera.cy && a.camera.distortion == b.camera.distortion;
}

bool fits(const RgbdFrame& frame, const PinholeCamera& camera) {
  return frame.color.width() == camera.width && frame.color.height() == camera.height &&
         frame.depth.width() == camera.width && frame.depth.height() == camera.height && frame.depth_scale > 0.0F;
}

// A camera's labels are the sensor right after it.
bool is_of_camera(const SensorFrame& frame) {
  return frame.kind == SensorKind::labels && frame.sensor == 1;
}

}  // namespace

SensorThread::SensorThread(SensorThreadOptions options, std::unique_ptr<Driver> driver, DriverSetup setup,
                           FrameExchange& frames, LabelRing* labels, Counters& counters, std::function<void()> on_end)
    : options_(std::move(options)),
      driver_(std::move(driver)),
      setup_(std::move(setup)),
      frames_(frames),
      labels_(labels),
      counters_(counters),
      on_end_(std::move(on_end)),
      last_stamp_(std::numeric_limits<TimeNs>::min()) {
  EXPECTS(driver_ != nullptr && !setup_.sensors.empty());
  counters_.sensors_up.fetch_add(1);
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

SensorThread::~SensorThread() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  driver_->close();
}

void SensorThread::run(const std::stop_token& stop) {
  name_this_thread("sensor " + options_.name);
  while (!stop.stop_requested()) {
    SensorFrame& frame = frames_.draft();
    frame.received = 0;
    const Next next = driver_->next(frame);
    counters_.feeder_cpu.store(thread_cpu_now(), std::memory_order_relaxed);
    switch (next.kind) {
      case Next::Kind::frame:
        if (labels_ != nullptr && is_of_camera(frame)) {
          hand_over_labels(frame);
        } else if (accept(frame)) {
          submit();
        }
        break;
      case Next::Kind::bad:
        if (counters_.dropped(DropReason::bad_frame) == 0) log::warn("{}: {}", options_.name, next.message);
        counters_.drop(DropReason::bad_frame);
        gaps_.bad();
        break;
      case Next::Kind::end:
        log::info("{}: the stream is over", options_.name);
        counters_.sensors_up.fetch_sub(1);
        if (on_end_) on_end_();
        return;
      case Next::Kind::failed:
        if (!reopen(stop, next.message)) return;
        break;
    }
  }
}

// Whether the frame is one that tracking can use; otherwise it has been counted.
bool SensorThread::accept(SensorFrame& frame) {
  counters_.frames_in.fetch_add(1, std::memory_order_relaxed);
  if (frame.received == 0) frame.received = monotonic_now();
  if (frame.kind != SensorKind::rgbd || frame.sensor != 0) {
    counters_.drop(DropReason::unused);
    return false;
  }
  if (const auto missing = gaps_.missing_before(frame.rgbd.seq); missing > 0) counters_.drop(DropReason::gap, missing);
  if (!fits(frame.rgbd, setup_.sensors[0].camera)) {
    counters_.drop(DropReason::bad_frame);
    return false;
  }
  if (frame.rgbd.stamp <= last_stamp_) {
    counters_.drop(DropReason::late);
    return false;
  }
  last_stamp_ = frame.rgbd.stamp;
  return true;
}

void SensorThread::hand_over_labels(SensorFrame& frame) {
  if (!labels_->try_push(std::move(frame.labels))) counters_.labels_dropped.fetch_add(1, std::memory_order_relaxed);
}

void SensorThread::submit() {
  // A device does not wait for us; a recording that is read unpaced does.
  const bool taken = setup_.paced ? frames_.try_submit() : frames_.submit_when_possible();
  if (!taken) counters_.drop(DropReason::ring_full);
}

// Until the device is back or the thread shall stop (false). Logs once when it goes and once when it is back.
bool SensorThread::reopen(const std::stop_token& stop, const std::string& why) {
  log::error("{}: {}; reopening until it is back", options_.name, why);
  counters_.sensors_up.fetch_sub(1);
  driver_->close();
  TimeNs wait = options_.first_pause;
  std::string reason;
  for (;;) {
    pause(stop, wait);
    if (stop.stop_requested()) return false;
    std::string reason_now;
    if (try_open(reason_now)) break;
    if (reason_now != reason) log::warn("{}: {}", options_.name, reason_now);
    reason = std::move(reason_now);
    wait = std::min(2 * wait, options_.longest_pause);
  }
  gaps_.reset();
  counters_.sensors_up.fetch_add(1);
  counters_.reopened.fetch_add(1);
  log::info("{}: back: {}", options_.name, setup_.description);
  return true;
}

bool SensorThread::try_open(std::string& why) {
  Result<DriverSetup> setup = driver_->open();
  if (!setup) {
    why = setup.error().message;
    return false;
  }
  if (setup->sensors.empty() || !same_camera(setup->sensors[0], setup_.sensors[0])) {
    why = setup->description + " has another calibration than before; restart the daemon to use it";
    driver_->close();
    return false;
  }
  setup_ = std::move(*setup);
  return true;
}

void SensorThread::pause(const std::stop_token& stop, TimeNs duration) {
  std::unique_lock lock(pause_mutex_);
  pause_.wait_for(lock, stop, std::chrono::nanoseconds(duration), [] { return false; });
}

}  // namespace povslam
