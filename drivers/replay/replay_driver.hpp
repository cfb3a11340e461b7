// Replays a recorded sequence: a TUM RGB-D folder (with our extras) or a TorWIC-SLAM run.
//
// Options:
//   path                      the folder
//   camera                    tum1 | tum2 | tum3 | 7scenes | 7scenes_registered or a camera.yaml file, for a folder
//   without camera.yaml frames                    "A:B", the main camera's frames A to B - 1; either side may be left
//   out or negative realtime                  true: next() returns when the frame is due by its stamp (gaps above 1 s
//   are cut to 1 s) labels                    true | false (default) | auto: class labels of the main camera (auto: if
//   recorded) association_tolerance_s   colour and depth further apart are no pair (default 0.02)
//
// Sensors: 0 is the main camera; labels, if asked for, are the sensor right after their camera, and a label frame comes
// right after the colour frame whose stamp it has; then further cameras and the LiDAR. All come in the order of their
// stamps. What is wrong in the lists is told first, one `bad` a line; a broken image costs its frame and nothing else.
// The start pose is never told: ground truth is for scoring.
#pragma once

#include <memory>

#include "drivers/driver.hpp"

namespace povslam {

Result<std::unique_ptr<Driver>> make_replay_driver(const DriverOptions& options);

}  // namespace povslam
