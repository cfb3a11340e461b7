// What is left of the landmarks once each is eliminated: 4x4 sums of constant points, whose rotation waits until after
// the sum (maximise_structured.cpp says what becomes of them).
#include "pipeline/backend/kernels/landmark.hpp"

namespace povslam::POVSLAM_ISA {

namespace {

struct BodySums {
  Lanes3 force{fill(0.0), fill(0.0), fill(0.0)};
  Lanes torque = fill(0.0), cost = fill(0.0);
  Lanes own[4] = {fill(0.0), fill(0.0), fill(0.0), fill(0.0)};
};

POVSLAM_INLINE Lanes root(Lanes a) {
  return Lanes{__builtin_sqrt(a[0]), __builtin_sqrt(a[1]), __builtin_sqrt(a[2]), __builtin_sqrt(a[3])};
}

POVSLAM_INLINE void put(Quad* out, Lanes scale, const Lanes3& d) {
  lanes(out[0]) = scale;
  lanes(out[1]) = scale * d.x;
  lanes(out[2]) = scale * d.y;
  lanes(out[3]) = scale * d.z;
}

POVSLAM_INLINE void add(Quad* out, Lanes weight, const Lanes3& a) {
  lanes(out[0]) += weight * a.x;
  lanes(out[1]) += weight * a.y;
  lanes(out[2]) += weight * a.z;
}

// Scaled homogeneous points of each frame and of the body into scratch, gradients into the sums.
POVSLAM_INLINE void prepare_block(const VemBlocks& blocks, const VemPlaces& places, int block, BodySums& body,
                                  Quad* frame_gradient, Quad* scratch) {
  const int frames = blocks.num_frames;
  BestPlace best;
  find_best(blocks, places, block, best);
  const Lanes inverse_root = root(best.inverse);
  Lanes matched = fill(0.0);
  for (int t = 0; t < frames; ++t) {
    const int slot = block * frames + t;
    const Lanes w = lanes(blocks.information[slot]);
    const Lanes3 &a = best.arm[t], r = shift(places.R_p + 12 * t + 9, a) - best.l;
    add(frame_gradient + 6 * t, w, r);
    add(frame_gradient + 6 * t + 3, w, {a.y * r.z - a.z * r.y, a.z * r.x - a.x * r.z, a.x * r.y - a.y * r.x});
    put(scratch + 4 * t, w * inverse_root, load3(blocks.p_camera + 3 * slot));
    matched += w * dot(r, r);
  }
  const Lanes rigid = lanes(blocks.rigid_weight[block]);
  const Lanes3 l_object = load3(blocks.p_object + 3 * block), &arm = best.body_arm;
  const Lanes3 r = shift(places.position, arm) - best.l;
  add_scaled(body.force, rigid, r);
  body.torque += rigid * (arm.x * r.y - arm.y * r.x);
  body.cost += matched + best.other_cost;
  put(scratch + 4 * frames, rigid * inverse_root, l_object);
  const Lanes c = rigid - rigid * rigid * best.inverse;
  body.own[0] += c;
  body.own[1] += c * l_object.x;
  body.own[2] += c * l_object.y;
  body.own[3] += c * (l_object.x * l_object.x + l_object.y * l_object.y);
}

// out (4 rows, `columns` columns) += sum over blocks of a b^T, a and b homogeneous points in scratch.
template <int columns>
POVSLAM_INLINE void add_outer(int num_blocks, int stride, const Quad* a, const Quad* b, Quad* out) {
  Lanes sums[4][columns];
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < columns; ++j) sums[i][j] = lanes(out[i * columns + j]);
  }
  for (int block = 0; block < num_blocks; ++block) {
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < columns; ++j) sums[i][j] += lanes(a[block * stride + i]) * lanes(b[block * stride + j]);
    }
  }
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < columns; ++j) lanes(out[i * columns + j]) = sums[i][j];
  }
}

// The same of a frame with itself, from unscaled points: sum (w - w^2 / W) [1; d] [1; d]^T. Lower half.
POVSLAM_INLINE void add_square(const VemBlocks& blocks, int first, int num_blocks, int t, const Quad* scratch,
                               Quad* out) {
  const int frames = blocks.num_frames;
  Lanes sums[4][4];
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j <= i; ++j) sums[i][j] = lanes(out[4 * i + j]);
  }
  for (int block = 0; block < num_blocks; ++block) {
    const int slot = (first + block) * frames + t;
    const Lanes scale = lanes(scratch[(block * (frames + 1) + t) * 4]);
    const Lanes c = lanes(blocks.information[slot]) - scale * scale;
    const Lanes3 d = load3(blocks.p_camera + 3 * slot), cd = weighted(c, d);
    sums[0][0] += c;
    sums[1][0] += cd.x;
    sums[1][1] += cd.x * d.x;
    sums[2][0] += cd.y;
    sums[2][1] += cd.y * d.x;
    sums[2][2] += cd.y * d.y;
    sums[3][0] += cd.z;
    sums[3][1] += cd.z * d.x;
    sums[3][2] += cd.z * d.y;
    sums[3][3] += cd.z * d.z;
  }
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j <= i; ++j) lanes(out[4 * i + j]) = sums[i][j];
  }
}

POVSLAM_INLINE bool any_weight(const VemBlocks& blocks, int first, int num_blocks, int t) {
  Lanes weight = fill(0.0);
  for (int block = first; block < first + num_blocks; ++block) {
    weight += lanes(blocks.information[block * blocks.num_frames + t]);
  }
  return sum(weight) > 0.0;
}

void add_chunk(const VemBlocks& blocks, int first, int num_blocks, bool rigid, Quad* frame_object, VemMoments& out) {
  const int frames = blocks.num_frames, stride = 4 * (frames + 1);
  int active[kVemMaxFrames], num_active = 0;
  for (int t = 0; t < frames; ++t) {
    if (any_weight(blocks, first, num_blocks, t)) active[num_active++] = t;
  }
  for (int i = 0; i < num_active; ++i) {
    const int t = active[i];
    const Quad* a = out.scratch + 4 * t;
    for (int j = 0; j < i; ++j) {
      add_outer<4>(num_blocks, stride, a, out.scratch + 4 * active[j], out.pairs + 16 * (t * frames + active[j]));
    }
    add_square(blocks, first, num_blocks, t, out.scratch, out.pairs + 16 * (t * frames + t));
    if (rigid) add_outer<3>(num_blocks, stride, a, out.scratch + 4 * frames, frame_object + 12 * t);
  }
}

}  // namespace

void moments(const VemBlocks* blocks, const VemPlaces* places, VemMoments* out) {
  const int frames = blocks->num_frames;
  BodySums body;
  Quad frame_object[12 * kVemMaxFrames];
  for (int i = 0; i < 12 * frames; ++i) lanes(frame_object[i]) = fill(0.0);
  const int num_chunks = (blocks->num_blocks + kVemChunk - 1) / kVemChunk;
  for (int chunk = 0; chunk < num_chunks; ++chunk) {  // of about the same size
    const int first = blocks->num_blocks * chunk / num_chunks;
    const int size = blocks->num_blocks * (chunk + 1) / num_chunks - first;
    for (int block = 0; block < size; ++block) {
      Quad* scratch = out->scratch + 4 * (frames + 1) * block;
      prepare_block(*blocks, *places, first + block, body, out->frame_gradient, scratch);
    }
    add_chunk(*blocks, first, size, sum(body.own[0]) > 0.0, frame_object, *out);
  }
  for (int i = 0; i < 12 * frames; ++i) out->frame_object[i] = sum(lanes(frame_object[i]));
  out->object_gradient[0] = sum(body.force.x);
  out->object_gradient[1] = sum(body.force.y);
  out->object_gradient[2] = sum(body.force.z);
  out->object_gradient[3] = sum(body.torque);
  for (int i = 0; i < 4; ++i) out->object[i] = sum(body.own[i]);
  out->cost = 0.5 * sum(body.cost);
}

}  // namespace povslam::POVSLAM_ISA
