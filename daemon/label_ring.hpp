// Labels on their way from whoever makes them to the understanding thread.
#pragma once

#include "pipeline/base/spsc_ring.hpp"
#include "pipeline/frames/label_frame.hpp"

namespace povslam {

using LabelRing = SpscRing<LabelFrame>;

}  // namespace povslam
