// A block of landmarks at their best: the weighted mean of where each residual wants them. Only for *.kernel.cpp.
#pragma once

#include "pipeline/backend/kernels/lanes.hpp"

namespace povslam::POVSLAM_ISA {

struct BestPlace {
  Lanes3 arm[kVemMaxFrames];  // R d of each frame: its point seen from the camera, in the world's axes
  Lanes3 body_arm;            // likewise in the object
  Lanes3 l;                   // the landmark
  Lanes inverse;              // 1 / sum of weights
  Lanes other_cost;           // sum of weighted squares of prior and rigidity there
};

POVSLAM_INLINE Lanes3 weighted(Lanes weight, const Lanes3& a) {
  return {weight * a.x, weight * a.y, weight * a.z};
}

POVSLAM_INLINE void find_best(const VemBlocks& blocks, const VemPlaces& places, int block, BestPlace& out) {
  const Quad* information = blocks.information + block * blocks.num_frames;
  const Lanes prior = lanes(blocks.prior_weight[block]), rigid = lanes(blocks.rigid_weight[block]);
  const Lanes3 prev = load3(blocks.p_prev + 3 * block);
  out.body_arm = turn(places, load3(blocks.p_object + 3 * block));
  const Lanes3 body = shift(places.position, out.body_arm);
  Lanes total = prior + rigid;
  Lanes3 mean = weighted(prior, prev);
  add_scaled(mean, rigid, body);
  for (int t = 0; t < blocks.num_frames; ++t) {
    const double* R_p = places.R_p + 12 * t;
    const Lanes w = lanes(information[t]);
    out.arm[t] = rotate(R_p, load3(blocks.p_camera + 3 * (block * blocks.num_frames + t)));
    total += w;
    add_scaled(mean, w, shift(R_p + 9, out.arm[t]));
  }
  out.inverse = 1.0 / total;
  out.l = weighted(out.inverse, mean);
  const Lanes3 from_prev = prev - out.l, from_body = body - out.l;
  out.other_cost = prior * dot(from_prev, from_prev) + rigid * dot(from_body, from_body);
}

}  // namespace povslam::POVSLAM_ISA
