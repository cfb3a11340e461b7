#include "drivers/synthetic/synthetic_driver.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include "drivers/synthetic/lidar.hpp"
#include "drivers/synthetic/renderer.hpp"
#include "drivers/synthetic/world.hpp"

namespace povslam {

namespace {

using synthetic::Lidar;
using synthetic::Renderer;
using synthetic::SyntheticOptions;
using synthetic::World;

class SyntheticDriver final : public Driver {
 public:
  explicit SyntheticDriver(SyntheticOptions options) : options_(std::move(options)) {}

  Result<DriverSetup> open() override {
    close();
    Result<World> world = World::create(options_);
    if (!world) return world.error();
    world_ = std::make_unique<World>(std::move(*world));
    renderer_ = std::make_unique<Renderer>(*world_);
    RgbdFrame first;
    renderer_->render_at(0.0, first);  // all that is in sight is painted before the clock runs
    lidar_ = std::make_unique<Lidar>(*world_);
    DriverSetup setup;
    setup.description = "simulated '" + options_.scene + "', seed " + std::to_string(options_.seed);
    setup.sensors = synthetic::sensor_calibrations(options_);
    setup.T_world_camera_start = world_->T_world_camera(0.0);
    setup.num_frames = world_->num_frames();
    if (options_.labels) setup.label_table = LabelTable{"synthetic", {}};
    setup.paced = options_.realtime;
    return setup;
  }

  Next next(SensorFrame& frame) override {
    if (world_ == nullptr) return {Next::Kind::failed, "the simulator is not open"};
    if (labels_due_) return deliver_labels(frame);
    if (frame_ >= world_->num_frames()) return {};
    const TimeNs camera_time = world_->frame_time(frame_), scan_time = scan_end(scan_);
    const bool scan_first = options_.lidar && scan_time <= camera_time;
    wait_for(scan_first ? scan_time : camera_time);
    return scan_first ? deliver_scan(frame) : deliver_image(frame);
  }

  void close() override {
    lidar_.reset();
    renderer_.reset();
    world_.reset();
    frame_ = scan_ = 0;
    labels_due_ = false;
    started_.reset();
  }

 private:
  static TimeNs scan_start(std::uint64_t scan) {
    return static_cast<TimeNs>(scan) * from_seconds(1.0 / Lidar::kRate_hz);
  }
  static TimeNs scan_end(std::uint64_t scan) { return scan_start(scan + 1); }

  // The drive starts with the first call. A consumer that comes late finds the frames between gone.
  void wait_for(TimeNs due) {
    if (!options_.realtime) return;
    if (!started_) started_ = monotonic_now() - due;
    const TimeNs ahead = *started_ + due - monotonic_now();
    if (ahead > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(ahead));
  }

  template <class TimeOf>
  void skip_to_present(std::uint64_t& index, std::uint64_t end, TimeOf time_of) const {
    if (!options_.realtime) return;
    const TimeNs now = monotonic_now() - *started_;
    while (index + 1 < end && time_of(index + 1) <= now) ++index;
  }

  Next deliver_image(SensorFrame& frame) {
    skip_to_present(frame_, world_->num_frames(), [this](std::uint64_t i) { return world_->frame_time(i); });
    const TimeNs time = world_->frame_time(frame_);
    renderer_->render_at(to_seconds(time), frame.rgbd);
    frame.kind = SensorKind::rgbd;
    frame.sensor = 0;
    frame.rgbd.stamp = frame.rgbd.depth_stamp = labels_stamp_ = world_->start_stamp() + time;
    frame.rgbd.seq = frame_++;
    frame.received = monotonic_now();
    labels_due_ = options_.labels;
    return {Next::Kind::frame, {}};
  }

  Next deliver_labels(SensorFrame& frame) {
    renderer_->label(frame.labels);
    frame.kind = SensorKind::labels;
    frame.sensor = 1;
    frame.labels.stamp = labels_stamp_;
    frame.received = frame.labels.produced = monotonic_now();
    labels_due_ = false;
    return {Next::Kind::frame, {}};
  }

  Next deliver_scan(SensorFrame& frame) {
    skip_to_present(scan_, ~std::uint64_t{0}, scan_end);
    lidar_->scan(to_seconds(scan_start(scan_)), frame.lidar);
    frame.kind = SensorKind::lidar;
    frame.sensor = options_.labels ? 2 : 1;
    frame.lidar.stamp = world_->start_stamp() + scan_start(scan_);
    frame.lidar.seq = scan_++;
    frame.received = monotonic_now();
    return {Next::Kind::frame, {}};
  }

  SyntheticOptions options_;
  std::unique_ptr<World> world_;
  std::unique_ptr<Renderer> renderer_;
  std::unique_ptr<Lidar> lidar_;
  std::uint64_t frame_ = 0, scan_ = 0;
  bool labels_due_ = false;
  TimeNs labels_stamp_ = 0;
  std::optional<TimeNs> started_;  // monotonic time of the drive's start
};

}  // namespace

Result<std::unique_ptr<Driver>> make_synthetic_driver(const DriverOptions& options) {
  Result<SyntheticOptions> parsed = synthetic::parse_options(options);
  if (!parsed) return parsed.error();
  return std::unique_ptr<Driver>(std::make_unique<SyntheticDriver>(std::move(*parsed)));
}

namespace synthetic {

std::vector<SensorCalibration> sensor_calibrations(const SyntheticOptions& options) {
  SensorCalibration camera{
      "front", SensorKind::rgbd, options.camera, 1000.0, options.fps, 0.0, RobotMotion::T_body_camera()};
  std::vector<SensorCalibration> sensors{camera};
  if (options.labels) {
    sensors.push_back(
        {"labels", SensorKind::labels, options.camera, 1000.0, options.fps, 0.0, RobotMotion::T_body_camera()});
  }
  if (options.lidar) {
    sensors.push_back({"lidar", SensorKind::lidar, {}, 1000.0, Lidar::kRate_hz, 0.0, RobotMotion::T_body_lidar()});
  }
  return sensors;
}

}  // namespace synthetic

}  // namespace povslam
