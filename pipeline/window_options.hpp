// Options of how variational EM is fed from tracking, and of what its answers do.
#pragma once

namespace povslam {

struct WindowOptions {
  int every_frames = 1;    // frames from one in the window to the next; each such frame is solved for. 0: no VEM
  int delay_frames = 1;    // an answer enters this many frames after it was asked for, or when it is late
  int frames = 8;          // in the window
  int max_matches = 4000;  // of a frame; where there are more, objects with many give up theirs first
  double vo_sigma_m = 0.02, vo_sigma_rad = 0.01;          // of odometry between neighbouring frames of the window
  double prior_sigma_m = 0.05, prior_sigma_rad = 0.0175;  // of the oldest one's pose
  double match_sigma_m = 0.02;                            // of a matched point, beside the noise of its depth
  double reach_m = 1.0;     // an object that is not found where it should be is looked for so far around
  int verdicts = 3;         // solves that must agree before an object is doubted, or believed again
  double correct_m = 0.05;  // a pose that differs by less from tracking's is left to tracking…
  double correct_rad = 0.02;
  int correct_matches = 40;  // …as is one that hangs on fewer
};

}  // namespace povslam
