// One RGB-D measurement. Colour and depth have the same size and are aligned (depth is given in the colour camera).
#pragma once

#include <cstdint>

#include "pipeline/base/time.hpp"
#include "pipeline/frames/image.hpp"

namespace povslam {

struct RgbdFrame {
  TimeNs stamp = 0;             // of the colour exposure
  TimeNs depth_stamp = 0;       // of the depth exposure
  std::uint64_t seq = 0;        // counts frames of this sensor as the device made them; a gap is a loss
  ImageU8 color;                // 1 channel grey or 3 channels R, G, B
  ImageU16 depth;               // along the optical axis; metres = value / depth_scale; 0 = no measurement
  float depth_scale = 1000.0F;  // depth units per metre
};

}  // namespace povslam
