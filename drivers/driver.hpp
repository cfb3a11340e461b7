// The one interface between bytes and frames. One folder per kind of driver; a vendor library stays inside its folder.
//
// What a frame promises: stamps of one sensor strictly increase; sizes equal the calibration's; colour and depth are
// aligned; buffers of the frame passed in are reused, so a warm driver allocates nothing of its own.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/label_table.hpp"
#include "pipeline/base/result.hpp"
#include "pipeline/frames/sensor_frame.hpp"

namespace povslam {

struct DriverSetup {
  std::string description;                     // one line for the log: what was opened
  std::vector<SensorCalibration> sensors;      // index = SensorFrame::sensor
  std::optional<Rigid3> T_world_camera_start;  // pose of sensor 0 at its first frame, if the source knows it
  std::optional<std::size_t> num_frames;       // how many frames of sensor 0 will come, if known
  std::optional<LabelTable> label_table;       // what the ids of its label frames mean; unset: none come, or not known
  bool paced = false;                          // true: next() delivers at the real rate (a device, a simulated device)
};

struct Next {
  enum class Kind {
    frame,  // a whole frame was written
    bad,    // one frame is lost (broken image, missing file, short packet); message says which; call again
    end,    // the stream is over
    failed  // the device is gone; message says which and what to do; close() and open() may bring it back
  };
  Kind kind = Kind::end;
  std::string message;
};

class Driver {
 public:
  virtual ~Driver() = default;
  virtual Result<DriverSetup> open() = 0;
  virtual Next next(SensorFrame& frame) = 0;  // blocks until a frame is there; a paced driver no longer than 1 s
  virtual void close() = 0;
};

// Driver options as text, key -> value, as they stand in the configuration's [[sensor]] table or on the command line.
// Each driver checks its own keys: an unknown key or bad value is an error that names the key.
using DriverOptions = std::map<std::string, std::string>;

}  // namespace povslam
