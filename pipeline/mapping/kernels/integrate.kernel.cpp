// Weighted running average of projective distances (Curless and Levoy 1996), and the emptying of space.
#include "pipeline/mapping/kernels/color.hpp"
#include "pipeline/mapping/kernels/rays.hpp"

namespace povslam::POVSLAM_ISA {
namespace {

constexpr float kFullUnits = 32000.0F;  // the truncation; as kDistanceUnits of volume.hpp
constexpr float kFreeUnits = 0.9F * kFullUnits;

struct Voxels {
  Floats stored, looks;  // distance and weight units
  Mask known, behind;    // looked at; and behind a surface
  Mask settled;          // free space that one more look cannot make freer
};

POVSLAM_INLINE Voxels load_voxels(const IntegratePass& pass, const int16_t* distance, const uint16_t* weight) {
  Voxels v;
  v.stored = load16(distance);
  v.looks = load16(weight);
  v.known = above(v.looks, fill(0.0F));
  v.behind = both(v.known, above(fill(0.0F), v.stored));
  v.settled = both(at_least(v.stored, fill(kFullUnits)), at_least(v.looks, fill(pass.units_per_look)));
  return v;
}

struct Look {
  Mask surface;      // the owner's surface is within the truncation
  Mask empty;        // nothing of the owner's can be here
  Mask free;         // of those: it is before what was measured
  Mask contradicts;  // the voxel tells of a surface that was seen through
  Floats observed;   // distance units
};

// Space is empty where the view sees beyond by more than the truncation. A voxel behind a surface contradicts the view
// if it sees clearly beyond that surface: by the margin and 2 sigma; if somebody else's surface is there, it is empty
// too.
POVSLAM_INLINE Look look_at_voxels(const IntegratePass& pass, const Rays& rays, const Voxels& v) {
  const Floats truncation = fill(pass.truncation_m), zero = fill(0.0F);
  const Ints pixel = gather(pass.look, rays.pixel, rays.inside);
  const Floats surface = to_floats(and_bits(pixel, 0xFFFF)) * fill(pass.look_unit_m);
  const Floats ahead = surface - rays.depth_m;
  const Mask measured = above(surface, zero);
  const Mask visible = but_not(rays.inside, both(measured, above(zero - truncation, ahead)));
  Look look;
  look.surface = both(both(measured, visible), at_least(truncation, ahead));
  look.observed = select(look.surface, ahead * fill(pass.units_per_m), fill(kFullUnits));
  look.empty = look.free = look.contradicts = but_not(measured, measured);
  const Floats stored_m = v.stored * fill(pass.m_per_unit);
  const Mask conflict = both(v.behind, above(ahead - stored_m, fill(pass.margin_m)));
  const Mask ask = but_not(but_not(visible, v.settled), but_not(look.surface, conflict));
  if (bits(ask) == 0) return look;

  const Ints clear = high_half(pixel);
  const Floats clear_to = to_floats(and_bits(clear, 0x7FFF)) * fill(2.0F * pass.look_unit_m);
  const Floats beyond = clear_to - rays.depth_m;
  const Floats past = beyond - stored_m - fill(pass.margin_m), z2 = clear_to * clear_to;
  const Floats variance = z2 * z2 * fill(pass.quadratic2) + fill(pass.floor2);
  const Mask past_surface = both(above(past, zero), above(past * past, fill(4.0F) * variance));
  const Mask others = both(both(v.known, above(clear, fill_int(0x7FFF))), past_surface);
  // What was never seen has no edges to be careful about.
  const Mask far_before = either(above(beyond, truncation), but_not(above(ahead, truncation), v.known));
  look.empty = both(but_not(ask, look.surface), either(far_before, others));
  look.free = both(look.empty, either(at_least(beyond, zero), far_before));
  look.contradicts = both(v.behind, either(look.empty, both(look.surface, past_surface)));
  return look;
}

// Behind the surface a look counts the less the further, for what lies there was not seen.
POVSLAM_INLINE Floats weight_units(const IntegratePass& pass, float units, Floats observed) {
  const Floats seen = lesser((observed + fill(kFullUnits)) * fill(pass.behind_per_unit), fill(1.0F));
  return greater(seen * fill(units), fill(1.0F));
}

}  // namespace

unsigned integrate_block(const IntegratePass* pass, const BlockPlace* place, int16_t* distance, uint16_t* weight,
                         uint8_t* color) {
  const Floats zero = fill(0.0F), one = fill(1.0F);
  unsigned changed = 0, emptied = 0;
  for (int voxel = 0; voxel < kVoxels; voxel += kLanes) {
    const Rays rays = project(pass->rays, place->origin, voxel);
    if (bits(rays.inside) == 0) continue;
    const Voxels v = load_voxels(*pass, distance + voxel, weight + voxel);
    const Look look = look_at_voxels(*pass, rays, v);
    const Mask touched = either(look.surface, look.empty);
    if (bits(touched) == 0) continue;

    // What contradicts an earlier surface halves its weight: the surface is gone after a few looks, however old it is.
    const Floats before = select(look.contradicts, round_down(v.looks * fill(0.5F)), v.looks);
    const Floats added =
        select(either(look.surface, look.free), weight_units(*pass, place->weight_units, look.observed), zero);
    const Floats sum = before + added, share = added / greater(sum, one);
    const Floats mean = nearest(v.stored + (look.observed - v.stored) * share);
    const Floats new_distance = select(touched, mean, v.stored);
    // Space that was free for long has no more weight than one look gives it: a thing that comes is there soon.
    const Mask still_free = both(look.free, above(v.stored, fill(kFreeUnits)));
    const Floats most = select(still_free, greater(v.looks, fill(pass->units_per_look)), fill(pass->max_weight_units));
    store16(distance + voxel, new_distance);
    store16(weight + voxel, select(touched, lesser(sum, most), v.looks));
    const Mask differs = either(above(new_distance, v.stored), above(v.stored, new_distance));
    changed |= bits(either(but_not(touched, v.known), differs));
    emptied |= bits(both(look.contradicts, look.empty));
    if (pass->color == nullptr) continue;
    const Mask near = both(look.surface, above(fill(pass->color_units), magnitude(look.observed)));
    if (bits(near) != 0) color_voxels(*pass, rays, near, share, color + 3 * voxel);
  }
  return (changed != 0 ? unsigned{kBlockChanged} : 0U) | (emptied != 0 ? unsigned{kBlockEmptied} : 0U);
}

}  // namespace povslam::POVSLAM_ISA
