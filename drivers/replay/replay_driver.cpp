#include "drivers/replay/replay_driver.hpp"

#include <chrono>
#include <thread>

#include "drivers/replay/depth_registration.hpp"
#include "drivers/replay/image_file.hpp"
#include "drivers/replay/pcd_file.hpp"
#include "drivers/replay/replay_options.hpp"
#include "drivers/replay/text_file.hpp"
#include "pipeline/frames/frame_merge.hpp"

namespace povslam {

namespace {

constexpr std::size_t kMaxScanBytes = std::size_t{256} << 20;
constexpr TimeNs kLongestWait = kNsPerSecond;

// Sleeps until a stamp is due, counted from the first one; a gap is cut to kLongestWait.
class Pacer {
 public:
  void wait_for(TimeNs stamp) {
    const TimeNs now = monotonic_now();
    if (!offset_ || stamp + *offset_ - now > kLongestWait) {
      offset_ = now + (offset_ ? kLongestWait : 0) - stamp;
    }
    const TimeNs ahead = stamp + *offset_ - now;
    if (ahead > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(ahead));
  }
  void restart() { offset_.reset(); }

 private:
  std::optional<TimeNs> offset_;  // host clock minus stamps
};

class ReplayDriver : public Driver {
 public:
  explicit ReplayDriver(ReplayOptions options) : options_(std::move(options)) {}

  Result<DriverSetup> open() override;
  Next next(SensorFrame& frame) override;
  void close() override;

 private:
  void queue_all();
  Status read(const SequenceSensor& sensor, std::size_t index, const SequenceEntry& entry, SensorFrame& frame);
  Status read_rgbd(const SequenceSensor& sensor, std::size_t index, const SequenceEntry& entry, RgbdFrame& frame);
  Status read_labels(const SequenceSensor& sensor, const SequenceEntry& entry, LabelFrame& frame);
  Status read_scan(const SequenceEntry& entry, LidarFrame& frame);

  ReplayOptions options_;
  Sequence sequence_;
  std::vector<std::optional<DepthRegistration>> registrations_;  // per sensor
  std::optional<FrameMerge> order_;
  std::size_t faults_told_ = 0;
  std::optional<TimeNs> lost_stamp_;  // of the main camera's last frame if it was broken: its labels are left out
  Pacer pacer_;
  ImageReader images_;
  ImageU16 unregistered_;
  std::vector<char> bytes_;
};

Result<DriverSetup> ReplayDriver::open() {
  close();
  Result<Sequence> sequence = read_sequence(options_.sequence);
  if (!sequence) return sequence.error();
  if (const Status status = cut_sequence(*sequence, options_.frames); !status) return status.error();
  sequence_ = std::move(*sequence);
  DriverSetup setup;
  for (const SequenceSensor& sensor : sequence_.sensors) {
    setup.sensors.push_back(sensor.calibration);
    registrations_.emplace_back();
    if (sensor.depth) {
      registrations_.back().emplace(*sensor.depth, sensor.calibration.camera, sensor.calibration.depth_scale);
    }
  }
  setup.label_table = sequence_.label_table;
  setup.num_frames = sequence_.sensors.front().entries.size();
  setup.paced = options_.realtime;
  setup.description = "replay of " + sequence_.description + ", " + std::to_string(*setup.num_frames) + " frames";
  queue_all();
  return setup;
}

void ReplayDriver::queue_all() {
  const int num_sensors = static_cast<int>(sequence_.sensors.size());
  order_.emplace(num_sensors, 0.0);
  for (int s = 0; s < num_sensors; ++s) {
    const std::vector<SequenceEntry>& entries = sequence_.sensors[static_cast<std::size_t>(s)].entries;
    for (std::size_t i = 0; i < entries.size(); ++i) EXPECTS(order_->push(s, entries[i].stamp, i));
    order_->finish(s);
  }
}

void ReplayDriver::close() {
  sequence_ = {};
  registrations_.clear();
  order_.reset();
  faults_told_ = 0;
  lost_stamp_.reset();
  pacer_.restart();
}

Next ReplayDriver::next(SensorFrame& frame) {
  if (!order_) return {Next::Kind::failed, "replay: not open"};
  if (faults_told_ < sequence_.faults.size()) return {Next::Kind::bad, sequence_.faults[faults_told_++]};
  while (const std::optional<FrameMerge::Item> item = order_->pop()) {
    const auto index = static_cast<std::size_t>(item->stream);
    const SequenceSensor& sensor = sequence_.sensors[index];
    if (sensor.calibration.kind == SensorKind::labels && lost_stamp_ == item->stamp) continue;
    const SequenceEntry& entry = sensor.entries[item->ticket];
    const Status status = read(sensor, index, entry, frame);
    if (options_.realtime) pacer_.wait_for(item->stamp);
    if (!status) {
      if (index == 0) lost_stamp_ = item->stamp;
      return {Next::Kind::bad, entry.where + ": " + status.error().message};
    }
    frame.kind = sensor.calibration.kind;
    frame.sensor = item->stream;
    frame.received = monotonic_now();
    return {Next::Kind::frame, {}};
  }
  return {Next::Kind::end, {}};
}

Status ReplayDriver::read(const SequenceSensor& sensor, std::size_t index, const SequenceEntry& entry,
                          SensorFrame& frame) {
  switch (sensor.calibration.kind) {
    case SensorKind::rgbd:
      return read_rgbd(sensor, index, entry, frame.rgbd);
    case SensorKind::labels:
      return read_labels(sensor, entry, frame.labels);
    case SensorKind::lidar:
      return read_scan(entry, frame.lidar);
  }
  return Error{"unknown kind of sensor"};
}

Status ReplayDriver::read_rgbd(const SequenceSensor& sensor, std::size_t index, const SequenceEntry& entry,
                               RgbdFrame& frame) {
  const PinholeCamera& camera = sensor.calibration.camera;
  const std::optional<DepthRegistration>& registration = registrations_[index];
  const PinholeCamera& depth_camera = sensor.depth ? sensor.depth->camera : camera;
  ImageU16& depth = registration ? unregistered_ : frame.depth;
  if (const Status s = images_.read_color(entry.file, {camera.width, camera.height}, frame.color); !s) return s;
  if (const Status s = images_.read_u16(entry.second_file, {depth_camera.width, depth_camera.height}, depth); !s)
    return s;
  if (registration) registration->warp(unregistered_, frame.depth);
  frame.stamp = entry.stamp;
  frame.depth_stamp = entry.depth_stamp;
  frame.seq = entry.seq;
  frame.depth_scale = static_cast<float>(sensor.calibration.depth_scale);
  return Done{};
}

Status ReplayDriver::read_labels(const SequenceSensor& sensor, const SequenceEntry& entry, LabelFrame& frame) {
  const ImageSize size{sensor.calibration.camera.width, sensor.calibration.camera.height};
  if (const Status s = images_.read_u8(entry.file, size, frame.classes); !s) return s;
  if (entry.second_file.empty()) {
    frame.instances.resize(0, 0);
  } else if (const Status s = images_.read_u16(entry.second_file, size, frame.instances); !s) {
    return s;
  }
  frame.stamp = entry.stamp;
  frame.produced = 0;
  frame.table_name = sequence_.label_table ? sequence_.label_table->name : std::string();
  return Done{};
}

Status ReplayDriver::read_scan(const SequenceEntry& entry, LidarFrame& frame) {
  if (const Status s = read_bytes(entry.file, kMaxScanBytes, bytes_); !s) return s;
  if (const Status s = decode_pcd(bytes_, frame.points); !s) return Error{entry.file + ": " + s.error().message};
  frame.stamp = entry.stamp;
  frame.seq = entry.seq;
  return Done{};
}

}  // namespace

Result<std::unique_ptr<Driver>> make_replay_driver(const DriverOptions& options) {
  Result<ReplayOptions> parsed = parse_replay_options(options);
  if (!parsed) return parsed.error();
  return std::unique_ptr<Driver>(std::make_unique<ReplayDriver>(std::move(*parsed)));
}

}  // namespace povslam
