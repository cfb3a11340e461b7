// Residuals of landmarks where they are, and landmarks where their residuals are least (method of the weighted mean).
#include "pipeline/backend/kernels/lanes.hpp"

namespace povslam::POVSLAM_ISA {

double measure(const VemBlocks* blocks, const VemPlaces* places, const Quad* landmark, Quad* error2) {
  const int frames = blocks->num_frames;
  Lanes cost = fill(0.0);
  for (int block = 0; block < blocks->num_blocks; ++block) {
    const Lanes3 l = load3(landmark + 3 * block);
    const Lanes3 from_prev = load3(blocks->p_prev + 3 * block) - l;
    const Lanes3 from_body = shift(places->position, turn(*places, load3(blocks->p_object + 3 * block))) - l;
    cost += lanes(blocks->prior_weight[block]) * dot(from_prev, from_prev) +
            lanes(blocks->rigid_weight[block]) * dot(from_body, from_body);
    for (int t = 0; t < frames; ++t) {
      const int slot = block * frames + t;
      const double* R_p = places->R_p + 12 * t;
      const Lanes3 e = shift(R_p + 9, rotate(R_p, load3(blocks->p_camera + 3 * slot))) - l;
      lanes(error2[slot]) = dot(e, e);
    }
  }
  return 0.5 * sum(cost);
}

double settle(const VemBlocks* blocks, const VemPlaces* places, Quad* landmark, Quad* error2) {
  const int frames = blocks->num_frames;
  Lanes cost = fill(0.0);
  for (int block = 0; block < blocks->num_blocks; ++block) {
    const Quad* information = blocks->information + block * frames;
    const Lanes3 prev = load3(blocks->p_prev + 3 * block);
    const Lanes3 body = shift(places->position, turn(*places, load3(blocks->p_object + 3 * block)));
    const Lanes prior = lanes(blocks->prior_weight[block]), rigid = lanes(blocks->rigid_weight[block]);
    Lanes3 seen[kVemMaxFrames];
    Lanes total = prior + rigid;
    Lanes3 mean = {prior * prev.x, prior * prev.y, prior * prev.z};
    add_scaled(mean, rigid, body);
    for (int t = 0; t < frames; ++t) {
      const double* R_p = places->R_p + 12 * t;
      seen[t] = shift(R_p + 9, rotate(R_p, load3(blocks->p_camera + 3 * (block * frames + t))));
      total += lanes(information[t]);
      add_scaled(mean, lanes(information[t]), seen[t]);
    }
    const Lanes inverse = 1.0 / total;
    const Lanes3 l = {mean.x * inverse, mean.y * inverse, mean.z * inverse};
    lanes(landmark[3 * block]) = l.x;
    lanes(landmark[3 * block + 1]) = l.y;
    lanes(landmark[3 * block + 2]) = l.z;
    const Lanes3 from_prev = prev - l, from_body = body - l;
    cost += prior * dot(from_prev, from_prev) + rigid * dot(from_body, from_body);
    for (int t = 0; t < frames; ++t) {
      const Lanes3 e = seen[t] - l;
      const Lanes square = dot(e, e);
      lanes(error2[block * frames + t]) = square;
      cost += lanes(information[t]) * square;
    }
  }
  return 0.5 * sum(cost);
}

}  // namespace povslam::POVSLAM_ISA
