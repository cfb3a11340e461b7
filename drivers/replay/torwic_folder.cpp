// TorWIC-SLAM runs (Barath et al., POV-SLAM, RSS 2023, data set) as they are published: image_left, depth_left,
// segmentation_greyscale_left, the right camera likewise, lidar; file names are frame indices and line n of
// frame_times.txt is the stamp of frame n. The body frame is the LiDAR's (x forward, z up).
#include <iomanip>
#include <sstream>

#include "drivers/replay/sequence.hpp"
#include "drivers/replay/text_file.hpp"

namespace povslam {

namespace {

namespace fs = std::filesystem;

constexpr double kDepthScale = 1000.0;
constexpr double kRate_hz = 10.0;
constexpr int kLongestName = 6;  // digits of a file name; the data set's description says four, the files have six

// Calibration of 12 October 2022 as published with the data set's tools; T_body_camera = T_lidar_camera.
struct Side {
  const char* name;
  PinholeCamera camera;
  Rigid3 T_body_camera;
};

std::vector<Side> built_in_sides() {
  const PinholeCamera left{
      1280,
      720,
      621.397474650905,
      620.649424677401,
      649.644481364277,
      367.908146431575,
      {0.0754678811883405, -0.0314893098110791, 0.00101924098521082, 0.00209529701722382, -0.00093522393662303}};
  const PinholeCamera right{
      1280,
      720,
      613.100554293744,
      613.903691840614,
      638.086832160361,
      378.314715743038,
      {0.087336570722973, -0.0669194159864173, 0.00495094616995581, 0.0007787469047987, 0.0221870772417529}};
  const Eigen::Quaterniond q_left(0.58668551, -0.61167248, 0.39292797, -0.3567415);
  const Eigen::Quaterniond q_right(-0.3618651, 0.41406507, -0.6100328, 0.57049433);
  return {{"left", left, {q_left.normalized(), {0.12944592, 0.04299934, -0.11374339}}},
          {"right", right, {q_right.normalized(), {0.07686256, -0.15441064, -0.1026438}}}};
}

bool is_folder(const fs::path& path) {
  std::error_code fault;
  return fs::is_directory(path, fault);
}

struct FrameTimes {
  std::vector<SequenceEntry> frames;  // stamp, seq and where; seq is the frame's index
  std::vector<std::string> faults;
};

Result<FrameTimes> read_frame_times(const fs::path& path) {
  const Result<TextFile> text = TextFile::read(path);
  if (!text) return text.error();
  FrameTimes times;
  std::uint64_t index = 0;
  for (const TextLine& line : text->lines()) {
    const std::optional<TimeNs> stamp = parse_seconds(line.words.front());
    const bool later = stamp && (times.frames.empty() || *stamp > times.frames.back().stamp);
    if (later) {
      times.frames.push_back({*stamp, *stamp, index, "", "", path.string() + ":" + std::to_string(line.number)});
    } else {
      times.faults.push_back(text->at(line) + (stamp ? "not after the frame before" : "no stamp in seconds") +
                             "; left out");
    }
    ++index;
  }
  if (times.frames.empty()) return Error{path.string() + ": holds no stamp"};
  return times;
}

// Digits of this folder's file names, by its first frame.
int name_digits(const fs::path& folder, const char* extension) {
  for (int digits = kLongestName; digits > 1; --digits) {
    if (is_file(folder / (std::string(static_cast<std::size_t>(digits), '0') + extension))) return digits;
  }
  return kLongestName;
}

std::string frame_file(const fs::path& folder, std::uint64_t index, int digits, const char* extension) {
  std::ostringstream name;
  name << std::setw(digits) << std::setfill('0') << index << extension;
  return (folder / name.str()).string();
}

std::vector<SequenceEntry> entries_in(const fs::path& folder, const char* extension, const FrameTimes& times) {
  const int digits = name_digits(folder, extension);
  std::vector<SequenceEntry> entries = times.frames;
  for (SequenceEntry& entry : entries) entry.file = frame_file(folder, entry.seq, digits, extension);
  return entries;
}

SequenceSensor camera_sensor(const fs::path& folder, const Side& side, const FrameTimes& times) {
  SequenceSensor sensor;
  sensor.calibration = {side.name, SensorKind::rgbd, side.camera, kDepthScale, kRate_hz, 0.0, side.T_body_camera};
  sensor.entries = entries_in(folder / (std::string("image_") + side.name), ".png", times);
  const std::vector<SequenceEntry> depth = entries_in(folder / (std::string("depth_") + side.name), ".png", times);
  for (std::size_t i = 0; i < depth.size(); ++i) sensor.entries[i].second_file = depth[i].file;
  return sensor;
}

SequenceSensor label_sensor(const fs::path& folder, const SequenceSensor& camera, const FrameTimes& times) {
  SequenceSensor sensor;
  sensor.calibration = camera.calibration;
  sensor.calibration.kind = SensorKind::labels;
  sensor.calibration.name += "_labels";
  sensor.entries = entries_in(folder, ".png", times);
  return sensor;
}

}  // namespace

bool is_torwic_folder(const fs::path& folder) {
  return is_folder(folder / "image_left");
}

Result<Sequence> read_torwic_folder(const SequenceOptions& options) {
  const fs::path& folder = options.folder;
  const Result<FrameTimes> times = read_frame_times(folder / "frame_times.txt");
  if (!times) return times.error();
  Sequence sequence;
  sequence.description = folder.string() + " (TorWIC-SLAM)";
  sequence.faults = times->faults;
  for (const Side& side : built_in_sides()) {
    if (!is_folder(folder / (std::string("image_") + side.name))) continue;
    sequence.sensors.push_back(camera_sensor(folder, side, *times));
    const fs::path labels = folder / (std::string("segmentation_greyscale_") + side.name);
    if (options.labels != LabelChoice::off && is_folder(labels)) {
      sequence.sensors.push_back(label_sensor(labels, sequence.sensors.back(), *times));
      sequence.label_table = LabelTable{"torwic", {}};
    } else if (options.labels == LabelChoice::on) {
      return Error{labels.string() + ": labels = true, but there is no such folder; set labels = false"};
    }
  }
  if (is_folder(folder / "lidar")) {
    SequenceSensor lidar;
    lidar.calibration = {"lidar", SensorKind::lidar, {}, kDepthScale, kRate_hz, 0.0, {}};
    lidar.entries = entries_in(folder / "lidar", ".pcd", *times);
    sequence.sensors.push_back(std::move(lidar));
  }
  return sequence;
}

}  // namespace povslam
