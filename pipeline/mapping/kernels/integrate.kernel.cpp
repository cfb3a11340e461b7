// Weighted running average of projective distances (Curless and Levoy 1996), and the emptying of space.
#include "pipeline/mapping/kernels/color.hpp"
#include "pipeline/mapping/kernels/rays.hpp"

namespace povslam::POVSLAM_ISA {
namespace {

// Space is free, and need not become freer, from here on.
constexpr float kFreeUnits = 0.9F * kFullUnits;
// Depth of what is not in the picture: behind everything.
constexpr float kNowhere = 1e12F;

struct Voxels {
  Floats stored, looks;  // distance and weight units
  Mask known, behind;    // looked at; and behind a surface
  Mask settled;          // free for a whole look: more would make a thing that comes appear later
};

POVSLAM_INLINE Voxels load_voxels(const int16_t* distance, const uint16_t* weight, float look_units) {
  Voxels v;
  v.stored = load16(distance);
  v.looks = load16(weight);
  v.known = above(v.looks, fill(0.0F));
  v.behind = both(v.known, above(fill(0.0F), v.stored));
  v.settled = both(above(v.stored, fill(kFreeUnits)), at_least(v.looks, fill(look_units)));
  return v;
}

struct Look {
  Mask surface;      // the owner's surface is within the truncation
  Mask empty;        // nothing of the owner's can be here
  Mask hidden;       // of those: behind what was measured
  Mask contradicts;  // the voxel tells of a surface that was seen through
  Floats observed;   // distance units
};

// Space is empty where the view sees beyond by more than the truncation. A voxel behind a surface contradicts the view
// if it sees clearly beyond that surface: by the margin and 2 sigma; if somebody else's surface is there, it is empty
// too.
POVSLAM_INLINE Look look_at_voxels(const IntegratePass& pass, Ints pixel, Floats depth, const Voxels& v) {
  const Floats full = fill(kFullUnits), zero = fill(0.0F);
  const Floats surface = to_floats(and_bits(pixel, 0xFFFF)) * fill(pass.look_unit), ahead = surface - depth;
  const Mask measured = above(surface, zero), not_hidden = at_least(ahead, fill(-kFullUnits));
  Look look;
  look.surface = both(both(measured, not_hidden), at_least(full, ahead));
  look.observed = select(look.surface, ahead, full);
  look.empty = look.hidden = look.contradicts = but_not(measured, measured);
  const Mask conflict = both(v.behind, above(ahead - v.stored, fill(pass.margin)));
  const Mask hidden_or_settled = either(but_not(measured, not_hidden), v.settled);
  const Mask ask = neither(hidden_or_settled, but_not(look.surface, conflict));
  if (bits(ask) == 0) return look;

  const Ints clear = high_half(pixel);
  const Floats clear_to = to_floats(and_bits(clear, 0x7FFF)) * fill(2.0F * pass.look_unit);
  const Floats beyond = clear_to - depth, past = beyond - v.stored - fill(pass.margin), z2 = clear_to * clear_to;
  const Mask past_surface =
      both(above(past, zero), above(past * past, z2 * z2 * fill(pass.quadratic) + fill(pass.floor)));
  const Mask others = both(both(v.known, above(clear, fill_int(0x7FFF))), past_surface);
  // What was never seen has no edges to be careful about.
  const Mask far_before = either(above(beyond, full), but_not(above(ahead, full), v.known));
  look.empty = both(but_not(ask, look.surface), either(far_before, others));
  look.hidden = but_not(look.empty, either(far_before, at_least(beyond, zero)));
  look.contradicts = both(v.behind, either(look.empty, both(look.surface, past_surface)));
  return look;
}

// Behind the surface a look counts the less the further, for what lies there was not seen.
POVSLAM_INLINE Floats weight_units(const IntegratePass& pass, float look_units, Floats observed) {
  const Floats seen = lesser((observed + fill(kFullUnits)) * fill(pass.behind_per_unit), fill(1.0F));
  return greater(seen * fill(look_units), fill(1.0F));
}

// Voxels of one block, in passes: each pass leaves behind what the next one reads.
struct Block {
  alignas(64) float depth[kVoxels];
  alignas(64) uint32_t pixel[kVoxels];      // its place in the look, then what stands there
  alignas(64) uint32_t color_at[kVoxels];   // bytes from pass->color on
  alignas(64) float share[kVoxels];         // of a new colour
  unsigned colored[int{kVoxels} / kLanes];  // bits of the lanes that take one
};

// Outside of the part: the look's last pixel, which says nothing.
POVSLAM_INLINE void project_all(const IntegratePass& pass, const float* origin, bool with_color, Block& block) {
  const Ints none = fill_int(pass.rays.columns * pass.rays.rows), channels = fill_int(pass.channels);
  const Ints color_stride = fill_int(static_cast<int>(pass.color_stride));
  for (int voxel = 0; voxel < kVoxels; voxel += kLanes) {
    const Rays rays = project(pass.rays, origin, voxel);
    store(block.depth + voxel, select(rays.inside, rays.depth, fill(kNowhere)));
    store(block.pixel + voxel, select(rays.inside, rays.pixel, none));
    if (!with_color) continue;
    const Ints at = add(multiply(rays.row, color_stride), multiply(rays.column, channels));
    store(block.color_at + voxel, select(rays.inside, at, fill_int(0)));
  }
}

// One after the other: gather instructions took longer (AVX-512, Zen 4). Two words a step.
POVSLAM_INLINE void read_look(const LookPixel* look, uint32_t* pixel) {
  for (int voxel = 0; voxel < kVoxels; voxel += 2) {
    uint64_t at;
    __builtin_memcpy(&at, pixel + voxel, sizeof at);
    uint64_t value = look[static_cast<uint32_t>(at)] | static_cast<uint64_t>(look[at >> 32]) << 32;
    __asm__("" : "+r"(value));  // or the compiler makes gathers of it
    __builtin_memcpy(pixel + voxel, &value, sizeof value);
  }
}

POVSLAM_INLINE void color_all(const IntegratePass& pass, Block& block, uint8_t* color) {
  for (int voxel = 0; voxel < kVoxels; voxel += kLanes) {
    if (block.colored[voxel / kLanes] != 0) read_pixels(pass, block.color_at + voxel);
  }
  for (int voxel = 0; voxel < kVoxels; voxel += kLanes) {
    const unsigned wanted = block.colored[voxel / kLanes];
    if (wanted == 0) continue;
    blend_colors(load(block.color_at + voxel), lanes_of(wanted), load(block.share + voxel), color + 3 * voxel);
  }
}

}  // namespace

unsigned integrate_block(const IntegratePass* pass, const BlockPlace* place, int16_t* distance, uint16_t* weight,
                         uint8_t* color) {
  Block block;
  const bool with_color = pass->color != nullptr;
  project_all(*pass, place->origin, with_color, block);
  read_look(pass->look, block.pixel);
  unsigned changed = 0, emptied = 0, colored = 0;
  for (int voxel = 0; voxel < kVoxels; voxel += kLanes) {
    const Voxels v = load_voxels(distance + voxel, weight + voxel, place->weight_units);
    const Look look = look_at_voxels(*pass, load(block.pixel + voxel), load(block.depth + voxel), v);
    block.colored[voxel / kLanes] = bits(look.surface);
    const Mask touched = either(look.surface, look.empty);
    if (bits(touched) == 0) continue;
    changed |= bits(touched);
    colored |= bits(look.surface);

    Floats before = v.looks, added = weight_units(*pass, place->weight_units, look.observed);
    if (bits(look.contradicts) != 0) {
      // An earlier surface that is seen through loses half of its weight: it is gone after a few looks, however old.
      before = select(look.contradicts, round_down(before * fill(0.5F)), before);
      added = select(look.hidden, fill(0.0F), added);
      emptied |= bits(both(look.contradicts, look.empty));
    }
    const Floats sum = before + added, share = added / greater(sum, fill(1.0F));
    store16(distance + voxel, select(touched, v.stored + (look.observed - v.stored) * share, v.stored));
    store16(weight + voxel, select(touched, lesser(sum, fill(pass->max_weight_units)), v.looks));
    store(block.share + voxel, share);
  }
  if (with_color && colored != 0) color_all(*pass, block, color);
  return (changed != 0 ? unsigned{kBlockChanged} : 0U) | (emptied != 0 ? unsigned{kBlockEmptied} : 0U);
}

}  // namespace povslam::POVSLAM_ISA
