// Residuals of landmarks where they are, and landmarks where their residuals are least.
#include "pipeline/backend/kernels/landmark.hpp"

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

VemCost settle(const VemBlocks* blocks, const VemPlaces* places, Quad* landmark, Quad* error2) {
  const int frames = blocks->num_frames;
  Lanes matched = fill(0.0), other = fill(0.0);
  for (int block = 0; block < blocks->num_blocks; ++block) {
    BestPlace best;
    find_best(*blocks, *places, block, best);
    lanes(landmark[3 * block]) = best.l.x;
    lanes(landmark[3 * block + 1]) = best.l.y;
    lanes(landmark[3 * block + 2]) = best.l.z;
    other += best.other_cost;
    for (int t = 0; t < frames; ++t) {
      const int slot = block * frames + t;
      const Lanes3 e = shift(places->R_p + 12 * t + 9, best.arm[t]) - best.l;
      const Lanes square = dot(e, e);
      lanes(error2[slot]) = square;
      matched += lanes(blocks->information[slot]) * square;
    }
  }
  return {0.5 * sum(matched), 0.5 * sum(other)};
}

}  // namespace povslam::POVSLAM_ISA
