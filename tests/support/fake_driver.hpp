// A camera that plays a script: frames of one textured scene, broken frames, failures, silence, the end.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "drivers/driver.hpp"

namespace povslam {

struct FakeStep {
  enum class Kind { frame, bad, fail, end, silence, other_sensor, wrong_size, labels } kind = Kind::frame;
  TimeNs stamp = 0;
  std::uint64_t seq = 0;
};

// Shared with the test, which looks on while the daemon's thread plays.
struct FakeScript {
  std::vector<FakeStep> steps;
  std::atomic<std::size_t> played{0};
  std::atomic<int> opened{0}, closed{0};
  int refuse_opens_from = 1, refuse_opens = 0;  // open() number n fails for from <= n < from + refuse
  bool paced = false;
  TimeNs period = 0;        // between frames
  bool repeat = false;      // after the steps: frames for ever
  int width_at_reopen = 0;  // another camera is plugged in
  bool has_labels = false;  // tells that label frames come; those are steps of kind labels

  FakeScript& frames(int count, std::uint64_t first_seq = 0) {
    for (int i = 0; i < count; ++i) {
      const std::uint64_t seq = first_seq + static_cast<std::uint64_t>(i);
      steps.push_back({FakeStep::Kind::frame, static_cast<TimeNs>(seq + 1) * 33 * kNsPerMs, seq});
    }
    return *this;
  }
  FakeScript& then(FakeStep::Kind kind) {
    steps.push_back({kind, 0, 0});
    return *this;
  }
};

class FakeDriver : public Driver {
 public:
  static constexpr int kWidth = 320, kHeight = 240;
  explicit FakeDriver(std::shared_ptr<FakeScript> script) : script_(std::move(script)) {
    color_.resize(kWidth, kHeight);
    std::mt19937 random(7);
    for (int y = 0; y < kHeight; y += 8) {
      for (int x = 0; x < kWidth; x += 8) square(x, y, static_cast<std::uint8_t>(random() % 256));
    }
  }

  Result<DriverSetup> open() override {
    const int n = script_->opened++;
    if (n >= script_->refuse_opens_from && n < script_->refuse_opens_from + script_->refuse_opens) {
      return Error{"fake camera: not there; plug it in"};
    }
    SensorCalibration camera;
    camera.camera = {kWidth, kHeight, 260.0, 260.0, 159.5, 119.5, {}};
    if (n > 0 && script_->width_at_reopen > 0) camera.camera.width = script_->width_at_reopen;
    DriverSetup setup;
    setup.description = "fake camera";
    setup.sensors = {camera};
    setup.paced = script_->paced;
    if (script_->has_labels) {
      setup.sensors.push_back(camera);
      setup.sensors.back().kind = SensorKind::labels;
      setup.label_table = LabelTable{"synthetic", {}};
    }
    return setup;
  }

  Next next(SensorFrame& frame) override {
    if (script_->period > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(script_->period));
    const std::size_t at = script_->played++;
    const bool over = at >= script_->steps.size();
    if (over && !script_->repeat) return {Next::Kind::end, ""};
    const FakeStep step =
        over ? FakeStep{FakeStep::Kind::frame, static_cast<TimeNs>(at + 1) * 33 * kNsPerMs, at} : script_->steps[at];
    switch (step.kind) {
      case FakeStep::Kind::bad:
        return {Next::Kind::bad, "fake camera: torn image"};
      case FakeStep::Kind::fail:
        return {Next::Kind::failed, "fake camera: gone; plug it in again"};
      case FakeStep::Kind::end:
        return {Next::Kind::end, ""};
      case FakeStep::Kind::silence:
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        return {Next::Kind::bad, "fake camera: silent"};
      case FakeStep::Kind::labels:
        fill_labels(frame, step);
        return {Next::Kind::frame, ""};
      default:
        break;
    }
    fill(frame, step);
    return {Next::Kind::frame, ""};
  }

  void close() override { ++script_->closed; }

 private:
  void square(int left, int top, std::uint8_t grey) {
    for (int y = top; y < top + 8; ++y) {
      for (int x = left; x < left + 8; ++x) color_.at(x, y) = grey;
    }
  }

  static void fill_labels(SensorFrame& frame, const FakeStep& step) {
    frame.kind = SensorKind::labels;
    frame.sensor = 1;
    frame.labels.stamp = step.stamp;
    frame.labels.table_name = "synthetic";
    frame.labels.classes.resize(kWidth, kHeight);
    frame.labels.classes.fill(1);
    frame.received = frame.labels.produced = monotonic_now();
  }

  void fill(SensorFrame& frame, const FakeStep& step) const {
    frame.kind = SensorKind::rgbd;
    frame.sensor = step.kind == FakeStep::Kind::other_sensor ? 1 : 0;
    frame.rgbd.stamp = frame.rgbd.depth_stamp = step.stamp;
    frame.rgbd.seq = step.seq;
    frame.rgbd.color = color_;
    frame.rgbd.depth.resize(step.kind == FakeStep::Kind::wrong_size ? kWidth / 2 : kWidth, kHeight);
    frame.rgbd.depth.fill(2000);
    frame.received = monotonic_now();
  }

  std::shared_ptr<FakeScript> script_;
  ImageU8 color_;
};

}  // namespace povslam
