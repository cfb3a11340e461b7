// The network that names segments (understanding.labels = "dnn"), from its file.
#pragma once

#include <memory>

#include "daemon/config.hpp"
#include "pipeline/base/result.hpp"
#include "pipeline/objects/segment_namer.hpp"

namespace povslam {

// Reads network.file and the class table (labels.classes; "auto": coco), and runs the network once: first in a process
// of its own, since a broken model can crash the library that reads it. Call it before other threads work. From then on
// OpenCV uses one thread. Errors name the key and the file.
Result<std::unique_ptr<SegmentNamer>> load_namer(const AppConfig& config);

}  // namespace povslam
