// One frame of any sensor, as drivers deliver it and rings carry it. Buffers are kept between uses.
#pragma once

#include "pipeline/frames/calibration.hpp"
#include "pipeline/frames/label_frame.hpp"
#include "pipeline/frames/lidar_frame.hpp"
#include "pipeline/frames/rgbd_frame.hpp"

namespace povslam {

struct SensorFrame {
  SensorKind kind = SensorKind::rgbd;  // says which of the members below is meant
  int sensor = 0;                      // index into the driver's (or the app's) list of sensors
  TimeNs received = 0;                 // host monotonic time when the driver had it whole
  RgbdFrame rgbd;
  LidarFrame lidar;
  LabelFrame labels;

  TimeNs stamp() const {
    switch (kind) {
      case SensorKind::rgbd:
        return rgbd.stamp;
      case SensorKind::lidar:
        return lidar.stamp;
      case SensorKind::labels:
        return labels.stamp;
    }
    return 0;
  }
};

}  // namespace povslam
