// What is left of the landmarks once each is eliminated: 4x4 sums of constant points, whose rotation waits until after
// the sum (performance of the structured solver: maximise_structured.cpp says what becomes of them).
#include "pipeline/backend/kernels/lanes.hpp"

namespace povslam::POVSLAM_ISA {

namespace {

struct Sum3 {
  Lanes3 v{fill(0.0), fill(0.0), fill(0.0)};
  void add(Lanes weight, const Lanes3& a) { add_scaled(v, weight, a); }
  void write(double* out) const {
    out[0] += sum(v.x);
    out[1] += sum(v.y);
    out[2] += sum(v.z);
  }
};

// One block: scaled homogeneous points of each frame and of the body into scratch, gradients into the sums.
struct Gradients {
  Sum3 force[kVemMaxFrames], torque[kVemMaxFrames], body_force;
  Lanes body_torque = fill(0.0);
  Lanes own[4] = {fill(0.0), fill(0.0), fill(0.0), fill(0.0)};  // of the body
};

POVSLAM_INLINE void put(Quad* out, Lanes scale, const Lanes3& d) {
  lanes(out[0]) = scale;
  lanes(out[1]) = scale * d.x;
  lanes(out[2]) = scale * d.y;
  lanes(out[3]) = scale * d.z;
}

POVSLAM_INLINE Lanes root(Lanes a) {
  return Lanes{__builtin_sqrt(a[0]), __builtin_sqrt(a[1]), __builtin_sqrt(a[2]), __builtin_sqrt(a[3])};
}

POVSLAM_INLINE void prepare_block(const VemBlocks& blocks, const VemPlaces& places, int block, Gradients& sums,
                                  Quad* scratch) {
  const int frames = blocks.num_frames;
  const Quad* information = blocks.information + block * frames;
  const Lanes3 prev = load3(blocks.p_prev + 3 * block), l_object = load3(blocks.p_object + 3 * block);
  const Lanes3 arm = turn(places, l_object), body = shift(places.position, arm);
  const Lanes prior = lanes(blocks.prior_weight[block]), rigid = lanes(blocks.rigid_weight[block]);
  Lanes3 seen[kVemMaxFrames];
  Lanes total = prior + rigid;
  Lanes3 mean = {prior * prev.x, prior * prev.y, prior * prev.z};
  add_scaled(mean, rigid, body);
  for (int t = 0; t < frames; ++t) {
    const double* R_p = places.R_p + 12 * t;
    seen[t] = rotate(R_p, load3(blocks.p_camera + 3 * (block * frames + t)));
    total += lanes(information[t]);
    add_scaled(mean, lanes(information[t]), shift(R_p + 9, seen[t]));
  }
  const Lanes inverse = 1.0 / total, inverse_root = root(inverse);
  const Lanes3 l = {mean.x * inverse, mean.y * inverse, mean.z * inverse};
  for (int t = 0; t < frames; ++t) {
    const Lanes w = lanes(information[t]);
    const Lanes3 r = shift(places.R_p + 12 * t + 9, seen[t]) - l, a = seen[t];
    sums.force[t].add(w, r);
    sums.torque[t].add(w, {a.y * r.z - a.z * r.y, a.z * r.x - a.x * r.z, a.x * r.y - a.y * r.x});
    put(scratch + 4 * t, w * inverse_root, load3(blocks.p_camera + 3 * (block * frames + t)));
  }
  const Lanes3 r = body - l;
  sums.body_force.add(rigid, r);
  sums.body_torque += rigid * (arm.x * r.y - arm.y * r.x);
  put(scratch + 4 * frames, rigid * inverse_root, l_object);
  const Lanes c = rigid - rigid * rigid * inverse;
  sums.own[0] += c;
  sums.own[1] += c * l_object.x;
  sums.own[2] += c * l_object.y;
  sums.own[3] += c * (l_object.x * l_object.x + l_object.y * l_object.y);
}

// out (4 rows, `columns` columns) += sum over blocks of a b^T, a and b homogeneous points in scratch.
template <int columns>
POVSLAM_INLINE void add_outer(int num_blocks, int stride, const Quad* a, const Quad* b, double* out) {
  Lanes sums[4][columns];
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < columns; ++j) sums[i][j] = fill(0.0);
  }
  for (int block = 0; block < num_blocks; ++block) {
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < columns; ++j) sums[i][j] += lanes(a[block * stride + i]) * lanes(b[block * stride + j]);
    }
  }
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < columns; ++j) out[i * columns + j] += sum(sums[i][j]);
  }
}

// The same with itself, from unscaled points: sum (w - w^2 / W) [1; d] [1; d]^T, w^2 / W being the squared scale.
POVSLAM_INLINE void add_square(const VemBlocks& blocks, int first, int num_blocks, int t, const Quad* scratch,
                               double* out) {
  const int frames = blocks.num_frames;
  Lanes sums[4][4];
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j <= i; ++j) sums[i][j] = fill(0.0);
  }
  for (int block = 0; block < num_blocks; ++block) {
    const int slot = (first + block) * frames + t;
    const Lanes scale = lanes(scratch[(block * (frames + 1) + t) * 4]);
    const Lanes c = lanes(blocks.information[slot]) - scale * scale;
    const Lanes3 d = load3(blocks.p_camera + 3 * slot);
    const Lanes h[4] = {fill(1.0), d.x, d.y, d.z};
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j <= i; ++j) sums[i][j] += c * h[i] * h[j];
    }
  }
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j <= i; ++j) out[4 * i + j] += sum(sums[i][j]);
  }
}

POVSLAM_INLINE bool any_weight(const VemBlocks& blocks, int first, int num_blocks, int t) {
  Lanes weight = fill(0.0);
  for (int block = first; block < first + num_blocks; ++block) {
    weight += lanes(blocks.information[block * blocks.num_frames + t]);
  }
  return sum(weight) > 0.0;
}

void add_chunk(const VemBlocks& blocks, int first, int num_blocks, bool rigid, VemMoments& out) {
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
    if (rigid) add_outer<3>(num_blocks, stride, a, out.scratch + 4 * frames, out.frame_object + 12 * t);
  }
}

}  // namespace

void moments(const VemBlocks* blocks, const VemPlaces* places, VemMoments* out) {
  const int frames = blocks->num_frames;
  Gradients sums;
  bool rigid = false;
  for (int i = 0; i < 12 * frames; ++i) out->frame_object[i] = 0.0;
  for (int first = 0; first < blocks->num_blocks; first += kVemChunk) {
    const int left = blocks->num_blocks - first, size = left < kVemChunk ? left : kVemChunk;
    for (int block = 0; block < size; ++block) {
      prepare_block(*blocks, *places, first + block, sums, out->scratch + 4 * (frames + 1) * block);
    }
    rigid = rigid || sum(sums.own[0]) > 0.0;
    add_chunk(*blocks, first, size, rigid, *out);
  }
  for (int t = 0; t < frames; ++t) {
    sums.force[t].write(out->frame_gradient + 6 * t);
    sums.torque[t].write(out->frame_gradient + 6 * t + 3);
  }
  for (double& value : out->object_gradient) value = 0.0;
  sums.body_force.write(out->object_gradient);
  out->object_gradient[3] = sum(sums.body_torque);
  for (int i = 0; i < 4; ++i) out->object[i] = sum(sums.own[i]);
}

}  // namespace povslam::POVSLAM_ISA
