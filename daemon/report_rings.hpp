// What is to be reported, on its way from two threads to the reporter.
#pragma once

#include "daemon/sink.hpp"

namespace povslam {

using PoseRing = SpscRing<TrackedFrame>;

struct ReportRings {
  ReportRings(std::size_t num_poses, std::size_t num_world) : poses(num_poses, &bell), world(num_world, &bell) {}

  Doorbell bell;     // of both
  PoseRing poses;    // from tracking
  ReportRing world;  // from understanding
};

}  // namespace povslam
