// Options of the whole journey.
#pragma once

#include "pipeline/backend/close_loop.hpp"
#include "pipeline/backend/smooth.hpp"
#include "pipeline/frontend/options.hpp"

namespace povslam {

struct BackendOptions {
  int delay_frames = 10;  // replay: the answer of a background job enters this many frames after it was asked for
  SmoothOptions smooth;
  CloseLoopOptions close_loop;
};

struct PipelineOptions {
  FrontendOptions frontend;
  BackendOptions backend;
};

}  // namespace povslam
