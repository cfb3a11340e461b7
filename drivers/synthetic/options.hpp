// What can be chosen about a simulated drive.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/driver.hpp"
#include "pipeline/geometry/camera.hpp"

namespace povslam::synthetic {

struct SyntheticOptions {
  std::string scene = "boxsim";  // one of scene_names()
  std::uint64_t seed = 1;
  double laps = 2.0;
  PinholeCamera camera{640, 480, 525.0, 525.0, 319.5, 239.5, {}};  // no distortion
  double fps = 30.0;
  double speed_mps = 0.6;
  double noise = 1.0;            // factor on every noise of the sensors; 0: perfect images, no dropout
  std::uint64_t noise_seed = 0;  // other draws of it in the same world; 0: as `seed` says
  bool blur = false;             // motion blur of an 8 ms exposure
  double max_depth_m = 8.0;      // depth beyond it reads 0
  bool labels = false;           // deliver class labels and instances too
  bool lidar = false;            // deliver LiDAR scans too
  bool changes = true;           // false: nothing moves, goes or comes after the first lap
  int movers = 0;                // people walking up and down
  bool realtime = true;          // driver: pace by the monotonic clock
  double start_time_s = 0.0;     // stamp of the first frame
  std::uint64_t frames = 0;      // stop after so many camera frames; 0: when the laps are done
};

std::vector<std::string> scene_names();

// Checks ranges; the message names the key.
Status validate(const SyntheticOptions& options);

// From text. A camera of another size without intrinsics keeps the default's angle of view.
Result<SyntheticOptions> parse_options(const DriverOptions& options);

}  // namespace povslam::synthetic
