// Semantic labels of one colour image, from whichever source. 0 = unlabelled.
#pragma once

#include <string>

#include "pipeline/base/time.hpp"
#include "pipeline/frames/image.hpp"

namespace povslam {

struct LabelFrame {
  TimeNs stamp = 0;        // of the colour image the labels were made from
  TimeNs produced = 0;     // when the source finished, on the host's monotonic clock; 0 = unknown
  ImageU8 classes;         // class id per pixel, aligned with colour, may be smaller (nearest upscaling)
  ImageU16 instances;      // optional (empty): instance id per pixel
  std::string table_name;  // class table the ids refer to
};

}  // namespace povslam
