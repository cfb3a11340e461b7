// The simulated warehouse as a driver: RGB-D camera "front", and when asked for class labels and a LiDAR.
#pragma once

#include <memory>
#include <vector>

#include "drivers/driver.hpp"
#include "drivers/synthetic/options.hpp"

namespace povslam {

// Keys as in SyntheticOptions. With `realtime` frames come at their time; a consumer that was late gets the present
// frame next, and seq shows how many were missed.
Result<std::unique_ptr<Driver>> make_synthetic_driver(const DriverOptions& options);

namespace synthetic {

// Sensors in the order of SensorFrame::sensor: camera, then labels, then LiDAR if these are on.
std::vector<SensorCalibration> sensor_calibrations(const SyntheticOptions& options);

}  // namespace synthetic

}  // namespace povslam
