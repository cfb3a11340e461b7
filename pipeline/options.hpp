// Options of the whole journey.
#pragma once

#include "pipeline/backend/close_loop.hpp"
#include "pipeline/backend/smooth.hpp"
#include "pipeline/backend/vem_options.hpp"
#include "pipeline/frontend/options.hpp"
#include "pipeline/mapping/empty_space.hpp"
#include "pipeline/mapping/integrate.hpp"
#include "pipeline/objects/options.hpp"
#include "pipeline/objects/segment.hpp"
#include "pipeline/objects/segment_namer.hpp"
#include "pipeline/window_options.hpp"

namespace povslam {

struct BackendOptions {
  int delay_frames = 10;  // the answer of a background job enters this many frames after it was asked for, or when late
  SmoothOptions smooth;
  CloseLoopOptions close_loop;
  VemOptions vem;
};

struct UnderstandingOptions {
  // off; geometric; dnn: geometric, named by a network; replay: frames of the driver; auto: those, else geometric
  std::string labels = "auto";
  double period_s = 0.2;             // between two views
  double label_max_latency_s = 3.0;  // a view waits so long for its labels
  double answer_delay_s = 0.15;      // what a view tells tracking enters so long after it was taken, or when it is late
  double change_period_s = 2.0;      // between two takings of what changed, for the store
  DepthViewOptions view;
  SegmentOptions segment;
  NamingOptions naming;
  VolumeOptions structure;
  VolumeOptions object{0.05, 0.2, 400};
  IntegrateOptions integrate;
  EmptySpaceOptions empty;
  ObjectOptions objects;
};

// Whether things are told apart by geometry, not by label frames.
inline bool by_geometry(const UnderstandingOptions& options) {
  return options.labels == "geometric" || options.labels == "dnn";
}

struct PipelineOptions {
  std::string mode = "pov";  // static: tracking knows nothing of objects, each landmark counts alike
  FrontendOptions frontend;
  BackendOptions backend;
  WindowOptions window;
  UnderstandingOptions understanding;
};

}  // namespace povslam
