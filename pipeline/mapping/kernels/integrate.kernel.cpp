// Weighted running average of projective distances (Curless and Levoy 1996), and the emptying of space.
#include "pipeline/mapping/kernels/rays.hpp"

namespace povslam::POVSLAM_ISA {
namespace {

constexpr float kFullUnits = 32000.0F;  // the truncation; as kDistanceUnits of volume.hpp
constexpr float kFreeUnits = 0.9F * kFullUnits;

struct Look {
  Mask surface;      // the owner's surface is within the truncation
  Mask empty;        // nothing of the owner's can be here
  Mask free;         // of those: it is before what was measured
  Mask contradicts;  // the voxel tells of a surface that was seen through
  Floats observed;   // distance units
};

POVSLAM_INLINE Floats sigma2(const IntegratePass& pass, Floats depth_m) {
  const Floats z2 = depth_m * depth_m;
  return z2 * z2 * fill(pass.quadratic2) + fill(pass.floor2);
}

// Space is empty where the view sees beyond by more than the truncation. A voxel behind a surface contradicts the view
// if it sees clearly beyond that surface: by the margin and 2 sigma; if somebody else's surface is there, it is empty
// too.
POVSLAM_INLINE Look look_at_voxels(const IntegratePass& pass, const Rays& rays, Floats stored, Mask known) {
  const Floats truncation = fill(pass.truncation_m), zero = fill(0.0F);
  const Floats surface = gather(pass.surface_m, rays.pixel, rays.inside);
  const Mask measured = above(surface, zero);
  const Floats ahead = surface - rays.depth_m;
  const Mask not_hidden = at_least(ahead, zero - truncation);
  Look look;
  look.surface = both(both(measured, not_hidden), at_least(truncation, ahead));
  look.observed = select(look.surface, ahead * fill(pass.units_per_m), fill(kFullUnits));
  look.empty = look.free = look.contradicts = but_not(measured, measured);
  const Mask behind = both(known, above(zero, stored));
  const Mask visible = but_not(rays.inside, but_not(measured, not_hidden));
  const Floats stored_m = stored * fill(1.0F / pass.units_per_m);
  const Mask as_it_was = but_not(look.surface, both(behind, above(ahead - stored_m, fill(pass.margin_m))));
  const Mask ask = but_not(visible, as_it_was);
  if (bits(ask) == 0) return look;

  const Floats clear = gather(pass.clear_m, rays.pixel, ask);
  const Floats clear_to = magnitude(clear), beyond = clear_to - rays.depth_m;
  const Floats past = beyond - stored_m - fill(pass.margin_m);
  const Mask past_surface = both(above(past, zero), above(past * past, fill(4.0F) * sigma2(pass, clear_to)));
  const Mask others = both(both(known, above(zero, clear)), past_surface);
  look.empty = both(but_not(ask, look.surface), either(above(beyond, truncation), others));
  look.free = both(look.empty, at_least(beyond, zero));
  look.contradicts = both(behind, either(look.empty, both(look.surface, past_surface)));
  return look;
}

// Looks; behind the surface they count the less the further, for what lies there was not seen.
POVSLAM_INLINE Floats weight_units(const IntegratePass& pass, Floats depth_m, Floats observed) {
  const Floats from_full = observed + fill(kFullUnits);
  const Floats seen = lesser(from_full * fill(pass.behind_per_unit), fill(1.0F));
  const Floats looks = lesser(fill(pass.good_sigma2) / sigma2(pass, depth_m), fill(1.0F)) * seen;
  return greater(nearest(looks * fill(pass.units_per_look)), fill(1.0F));
}

// A colour moves by at least an eighth, or old looks would hold it for ever. Black: none yet.
POVSLAM_INLINE void blend_color(const uint8_t* seen, int channels, float share, uint8_t* color) {
  share = (color[0] | color[1] | color[2]) == 0 ? 1.0F : share > 0.125F ? share : 0.125F;
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
    const Floats before = select(look.contradicts, round_down(looks * fill(0.5F)), looks);
    const Floats added =
        select(either(look.surface, look.free), weight_units(*pass, rays.depth_m, look.observed), zero);
    const Floats sum = before + added;
    const Floats mean = nearest((stored * before + look.observed * added) / greater(sum, fill(1.0F)));
    const Floats new_distance = select(touched, mean, stored);
    // Space that was free for long has no more weight than one look gives it: a thing that comes is there soon.
    const Mask still_free = both(look.free, above(stored, fill(kFreeUnits)));
    const Floats most = select(still_free, greater(looks, fill(pass->units_per_look)), fill(pass->max_weight_units));
    const Floats new_weight = select(touched, lesser(sum, most), looks);
    store16(distance + voxel, new_distance);
    store16(weight + voxel, new_weight);
    changed |= bits(either(but_not(touched, known), either(above(new_distance, stored), above(stored, new_distance))));
    emptied |= bits(both(look.contradicts, look.empty));
    if (pass->color == nullptr) continue;
    const Mask near = both(look.surface, above(fill(pass->color_units), magnitude(look.observed)));
    if (bits(near) != 0) color_voxels(*pass, rays, near, added / greater(sum, fill(1.0F)), color + 3 * voxel);
  }
  return (changed != 0 ? unsigned{kBlockChanged} : 0U) | (emptied != 0 ? unsigned{kBlockEmptied} : 0U);
}

}  // namespace povslam::POVSLAM_ISA
