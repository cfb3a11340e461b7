// Weighted running average of projective distances (Curless and Levoy 1996), and the emptying of space.
#include "pipeline/mapping/kernels/rays.hpp"

namespace povslam::POVSLAM_ISA {
namespace {

constexpr float kFullUnits = 32000.0F;  // the truncation; as kDistanceUnits of volume.hpp

struct Look {
  Mask surface;     // the owner's surface is within the truncation
  Mask empty;       // nothing of the owner's can be here
  Mask free;        // of those: it is before what was measured
  Floats observed;  // distance units
};

POVSLAM_INLINE Floats sigma2(const IntegratePass& pass, Floats depth_m) {
  const Floats z2 = depth_m * depth_m;
  return z2 * z2 * fill(pass.quadratic2) + fill(pass.floor2);
}

// Space is empty where the view sees beyond by more than the truncation; where the surface seen is somebody else's, by
// more than the margin beyond the surface that this voxel tells of is enough.
POVSLAM_INLINE Look look_at_voxels(const IntegratePass& pass, const Rays& rays, Floats stored, Mask known) {
  const Floats truncation = fill(pass.truncation_m), zero = fill(0.0F);
  const Floats surface = gather(pass.surface_m, rays.pixel, rays.inside);
  const Mask measured = above(surface, zero);
  const Floats ahead = surface - rays.depth_m;
  const Mask not_hidden = at_least(ahead, zero - truncation);
  Look look;
  look.surface = both(both(measured, not_hidden), at_least(truncation, ahead));
  look.observed = select(look.surface, ahead * fill(pass.units_per_m), fill(kFullUnits));
  const Mask ask = but_not(but_not(rays.inside, look.surface), but_not(measured, not_hidden));
  look.empty = look.free = but_not(ask, ask);
  if (bits(ask) == 0) return look;
  const Floats clear = gather(pass.clear_m, rays.pixel, ask);
  const Floats measured_to = magnitude(clear), beyond = measured_to - rays.depth_m;
  const Mask far_before = both(ask, above(beyond, truncation));
  const Mask others = both(both(ask, known), above(zero, clear));
  const Floats past_surface = beyond - stored * fill(1.0F / pass.units_per_m) - fill(pass.margin_m);
  const Mask positive = above(past_surface, zero);
  const Mask through =
      both(both(others, positive), above(past_surface * past_surface, fill(9.0F) * sigma2(pass, measured_to)));
  look.empty = either(far_before, through);
  look.free = both(look.empty, at_least(beyond, zero));
  return look;
}

POVSLAM_INLINE Floats weight_units(const IntegratePass& pass, Floats depth_m) {
  const Floats looks = lesser(fill(pass.good_sigma2) / sigma2(pass, depth_m), fill(1.0F));
  return greater(nearest(looks * fill(pass.units_per_look)), fill(1.0F));
}

// A colour moves by at least an eighth, or old looks would hold it for ever.
POVSLAM_INLINE void blend_color(const uint8_t* seen, int channels, float share, uint8_t* color) {
  share = share > 0.125F ? share : 0.125F;
  for (int c = 0; c < 3; ++c) {
    const float have = color[c], want = seen[channels == 3 ? c : 0];
    color[c] = static_cast<uint8_t>(have + (want - have) * share + 0.5F);
  }
}

POVSLAM_INLINE void color_voxels(const IntegratePass& pass, const Rays& rays, Mask mask, Floats share, uint8_t* color) {
  alignas(64) int32_t row[kLanes], column[kLanes];
  alignas(64) float part[kLanes];
  store(row, rays.row);
  store(column, rays.column);
  store(part, share);
  for (unsigned left = bits(mask); left != 0; left &= left - 1) {
    const int lane = __builtin_ctz(left);
    const uint8_t* seen = pass.color + row[lane] * pass.color_stride + column[lane] * pass.channels;
    blend_color(seen, pass.channels, part[lane], color + 3 * lane);
  }
}

}  // namespace

unsigned integrate_block(const IntegratePass* pass, const float* origin, int16_t* distance, uint16_t* weight,
                         uint8_t* color) {
  const Floats zero = fill(0.0F);
  unsigned changed = 0, emptied = 0;
  for (int voxel = 0; voxel < kVoxels; voxel += kLanes) {
    const Rays rays = project(pass->rays, origin, voxel);
    if (bits(rays.inside) == 0) continue;
    const Floats stored = load16(distance + voxel), looks = load16(weight + voxel);
    const Mask known = above(looks, zero);
    const Look look = look_at_voxels(*pass, rays, stored, known);
    const Mask touched = either(look.surface, look.empty);
    if (bits(touched) == 0) continue;

    // What contradicts an earlier surface halves its weight: the surface is gone after a few looks, however old it is.
    const Mask contradicts = both(look.empty, above(zero, stored));
    const Floats before = select(contradicts, round_down(looks * fill(0.5F)), looks);
    const Floats added = select(either(look.surface, look.free), weight_units(*pass, rays.depth_m), zero);
    const Floats sum = before + added;
    const Floats mean = nearest((stored * before + look.observed * added) / greater(sum, fill(1.0F)));
    const Floats new_distance = select(touched, mean, stored);
    const Floats new_weight = select(touched, lesser(sum, fill(pass->max_weight_units)), looks);
    store16(distance + voxel, new_distance);
    store16(weight + voxel, new_weight);
    changed |= bits(either(but_not(touched, known), either(above(new_distance, stored), above(stored, new_distance))));
    emptied |= bits(both(both(look.empty, known), above(fill(0.5F * kFullUnits), stored)));
    if (pass->color == nullptr) continue;
    const Mask near = both(look.surface, above(fill(pass->color_units), magnitude(look.observed)));
    if (bits(near) != 0) color_voxels(*pass, rays, near, added / greater(sum, fill(1.0F)), color + 3 * voxel);
  }
  return (changed != 0 ? unsigned{kBlockChanged} : 0U) | (emptied != 0 ? unsigned{kBlockEmptied} : 0U);
}

}  // namespace povslam::POVSLAM_ISA
