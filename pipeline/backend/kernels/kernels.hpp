// The variational EM's vector kernels: plain functions on raw pointers, compiled once per instruction set
// (*.kernel.cpp) and picked at run time (dispatch.hpp). Every set returns the same bits. Kernel sources include nothing
// but this and lanes.hpp.
//
// Landmarks lie in blocks of kVemLanes, all of one object. Arrays are by block, then frame, then axis, as `Quad`s;
// a match that is not there has inverse variance 0, a lane without landmark has prior weight 1 at the origin.
// All of a landmark's residuals are "target minus landmark": with the noise isotropic, that of rigidity has the same
// norm in the world as in the object's frame. So its best place is a weighted mean, and what remains is small.
#pragma once

#include <stdint.h>

namespace povslam {

enum { kVemLanes = 4 };
enum { kVemMaxFrames = 32 };
struct alignas(32) Quad {
  double lane[kVemLanes];
};

struct VemBlocks {  // of one object: pointers to its first block
  int num_blocks, num_frames;
  const Quad* p_camera;      // block, frame, axis
  const Quad* information;   // block, frame: weight / variance of a match [1/m^2]
  const Quad* p_object;      // block, axis
  const Quad* p_prev;        // block, axis
  const Quad* prior_weight;  // block [1/m^2]
  const Quad* rigid_weight;  // block [1/m^2]
};

struct VemPlaces {                       // where things are
  const double* R_p;                     // frame: 9 of R_world_camera by row, 3 of the camera's position
  double cos_yaw, sin_yaw, position[3];  // of the object
};

struct VemNoise {                 // of an object's matches, by block and frame
  int count;                      // Quads
  const Quad* inverse_variance;   // their own [1/m^2]; 0: no match
  const Quad* bias;               // log density of the Gaussian at 0 less that of the uniform
  double most_inverse, its_bias;  // a larger inverse variance counts as this one, with its bias
};

struct VemExpect {
  double odds;        // logarithm, before the residual is looked at
  double sum_pi;      // out
  double sum_excess;  // out: sum of log(1 + exp(logit)), what the ELBO is made of
};

struct VemDecision {
  int accepted, flipped;  // flipped: otherwise than information said before
};

struct VemCost {
  double matched, other;  // 1/2 sum of weighted squares of matches; of prior and rigidity
};

enum { kVemChunk = 34 };  // blocks at a time: what they need stays in the first cache

// Sums over an object's landmarks for its pair with each frame. `Quad`s are summed by lane only.
struct VemMoments {
  // Frames t, s <= t, at 16 * (t * num_frames + s): sum c [1; d_t] [1; d_s]^T by row, in the cameras' axes, where c is
  // w_t w_s / W; for s = t it is w_t - w_t^2 / W and only the lower half is set. Added to.
  Quad* pairs;
  Quad* frame_gradient;       // frame: sum w r, sum w (R d) x r in the world. Added to.
  double* frame_object;       // frame: 12 of sum c [1; d_t] [1; lx; ly]^T by row
  Quad* scratch;              // kVemChunk * (num_frames + 1) * 4
  double object[4];           // sum c, c lx, c ly, c (lx^2 + ly^2), c = w - w^2 / W
  double object_gradient[4];  // sum w r, sum w (S R l) . r
  double cost;                // 1/2 sum of weighted squares, landmarks at their best
};

struct VemKernels {
  // Squared residuals [m^2] by block, frame, of landmarks where they are; returns the cost of prior and rigidity.
  double (*measure)(const VemBlocks* blocks, const VemPlaces* places, const Quad* landmark, Quad* error2);
  // Landmarks to their best places, squared residuals there.
  VemCost (*settle)(const VemBlocks* blocks, const VemPlaces* places, Quad* landmark, Quad* error2);
  // E[pi] = sigmoid(odds + bias - error2 / 2 variance), 0 without match.
  void (*expect)(const VemNoise* noise, const Quad* error2, VemExpect* expect, Quad* pi);
  // information = pi / variance where odds + bias - error2 / 2 variance >= 0, else 0.
  VemDecision (*gate)(const VemNoise* noise, double odds, const Quad* error2, const Quad* pi, Quad* information);
  void (*moments)(const VemBlocks* blocks, const VemPlaces* places, VemMoments* moments);
};

}  // namespace povslam
