// What a recorded folder holds, known from its lists before any image is opened.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "drivers/label_table.hpp"
#include "drivers/replay/camera_file.hpp"
#include "pipeline/base/result.hpp"
#include "pipeline/base/time.hpp"
#include "pipeline/frames/calibration.hpp"

namespace povslam {

struct SequenceEntry {
  TimeNs stamp = 0;
  TimeNs depth_stamp = 0;   // rgbd only
  std::uint64_t seq = 0;    // counts the list's lines, so that a line left out is a gap
  std::string file;         // colour, classes or scan
  std::string second_file;  // depth or instances; empty: none
  std::string where;        // "list:line", for messages
};

struct SequenceSensor {
  SensorCalibration calibration;
  std::optional<DepthCamera> depth;    // rgbd whose depth must be warped into colour
  std::vector<SequenceEntry> entries;  // stamps strictly increase
};

struct Sequence {
  std::string description;
  std::vector<SequenceSensor> sensors;  // sensor 0 is the main camera; a camera's labels follow it directly
  std::optional<LabelTable> label_table;
  std::vector<std::string> faults;  // list lines that cannot be used, one message each
};

enum class LabelChoice { off, on, automatic };  // on: an error when there are none; automatic: if there are any

struct SequenceOptions {
  std::filesystem::path folder;
  std::string camera;  // preset or file, for a folder without camera.yaml
  LabelChoice labels = LabelChoice::off;
  double association_tolerance_s = 0.02;
};

// frames begin:end of the main camera, as Python slices: half open, negative counts from the end, a side left out is
// the first or the last.
struct FrameRange {
  std::optional<std::int64_t> begin, end;
};

// Any folder layout this house reads: TorWIC-SLAM if it has image_left/, else TUM RGB-D with our extras.
Result<Sequence> read_sequence(const SequenceOptions& options);

// Keeps the range of the main camera's frames and what the other sensors measured meanwhile. An empty range is an
// error.
Status cut_sequence(Sequence& sequence, const FrameRange& range);

Result<Sequence> read_tum_folder(const SequenceOptions& options);
bool is_torwic_folder(const std::filesystem::path& folder);
Result<Sequence> read_torwic_folder(const SequenceOptions& options);

}  // namespace povslam
