// What one view says to one owner's volume, pixel by pixel.
#include "pipeline/mapping/kernels/kernels.hpp"
#include "pipeline/mapping/kernels/lanes.hpp"

namespace povslam::POVSLAM_ISA {
namespace {

enum { kWindow = 2 * kClearRadius + 1, kFar = 65535 };

struct RowWindow {
  uint16_t* nearest;  // depth [unit], kFar: none
  uint8_t* doubtful;  // 1: a surface is mine or nobody's
};

// Rows kept between the passes, each as long as a padded one.
struct Rows {
  RowWindow padded, reduced[kWindow];
  uint16_t *mine[kWindow], *clear, *most;
};
static_assert(int{kLookScratch} == 3 * int{kWindow} + 4);

POVSLAM_INLINE Rows split_rows(uint16_t* scratch, int padded_columns) {
  const auto next = [&] { return scratch += padded_columns, scratch - padded_columns; };
  const auto next_window = [&] {
    uint16_t* nearest = next();
    return RowWindow{nearest, reinterpret_cast<uint8_t*>(next())};
  };
  Rows rows;
  rows.padded = next_window();
  for (int j = 0; j < kWindow; ++j) rows.reduced[j] = next_window(), rows.mine[j] = next();
  rows.clear = next(), rows.most = next();
  return rows;
}

POVSLAM_INLINE void fill_row(RowWindow row, int begin, int end) {
  for (int k = begin; k < end; ++k) row.nearest[k] = kFar, row.doubtful[k] = 0;
}

// Rounded to units, kMostUnits at most.
POVSLAM_INLINE void to_units(const float* depth_m, int count, float per_m, uint16_t* units) {
  int k = 0;
  for (; k + kLanes <= count; k += kLanes) {
    store16(units + k, lesser(load(depth_m + k) * fill(per_m), fill(kMostUnits)));
  }
  float rest[kLanes] = {};
  uint16_t rest_units[kLanes];
  for (int j = 0; k + j < count; ++j) rest[j] = depth_m[k + j];
  store16(rest_units, lesser(load(rest) * fill(per_m), fill(kMostUnits)));
  for (int j = 0; k + j < count; ++j) units[k + j] = rest_units[j];
}

// Reads a row of the image, kClearRadius more on both sides. mine: the depth of what is mine. Returns whether anything
// was measured.
POVSLAM_INLINE bool read_row(const LookSource& source, int y, RowWindow out, uint16_t* mine) {
  const int columns = source.columns + 2 * kClearRadius, from = source.x0 - kClearRadius;
  const int begin = from < 0 ? -from : 0;
  const int end = from + columns > source.width ? source.width - from : columns;
  const float* depth = source.depth_m + static_cast<int64_t>(y) * source.stride + from;
  const uint16_t* owner = source.owner + static_cast<int64_t>(y) * source.stride + from;
  fill_row(out, 0, begin);
  fill_row(out, end, columns);
  to_units(depth + begin, end - begin, 1.0F / source.unit_m, out.nearest + begin);
  const uint16_t nobody = source.nobody, me = source.mine;
  uint16_t* nearest = out.nearest;
  uint8_t* doubtful = out.doubtful;
  uint16_t any = 0;
#pragma omp simd reduction(| : any)
  for (int k = begin; k < end; ++k) {
    const uint16_t units = nearest[k];
    any = static_cast<uint16_t>(any | units);
    const auto is_mine = static_cast<uint16_t>(owner[k] == me), is_nobody = static_cast<uint16_t>(owner[k] == nobody);
    nearest[k] = units > 0 ? units : static_cast<uint16_t>(kFar);
    mine[k] = is_mine != 0 ? units : static_cast<uint16_t>(0);
    doubtful[k] = static_cast<uint8_t>(is_mine | (is_nobody & static_cast<uint16_t>(units > 0)));
  }
  return any != 0;
}

// Over the windows along the row.
POVSLAM_INLINE void reduce_nearest(int columns, const uint16_t* in, uint16_t* out) {
#pragma omp simd
  for (int k = 0; k < columns; ++k) {
    uint16_t nearest = in[k];
    for (int j = 1; j < kWindow; ++j) nearest = in[k + j] < nearest ? in[k + j] : nearest;
    out[k] = nearest;
  }
}
POVSLAM_INLINE void reduce_doubtful(int columns, const uint8_t* in, uint8_t* out) {
#pragma omp simd
  for (int k = 0; k < columns; ++k) {
    out[k] = static_cast<uint8_t>(in[k] | in[k + 1] | in[k + 2] | in[k + 3] | in[k + 4]);
  }
}

// In loops over values of few widths: compilers make vectors of each, whatever the instruction set.
POVSLAM_INLINE void join_rows(int columns, const Rows& rows, const uint16_t* mine, LookPixel* look) {
  static_assert(kWindow == 5);
  const RowWindow* r = rows.reduced;
  const uint16_t *n0 = r[0].nearest, *n1 = r[1].nearest, *n2 = r[2].nearest, *n3 = r[3].nearest, *n4 = r[4].nearest;
  const uint8_t *d0 = r[0].doubtful, *d1 = r[1].doubtful, *d2 = r[2].doubtful, *d3 = r[3].doubtful, *d4 = r[4].doubtful;
  uint16_t* clear = rows.clear;
  uint8_t* doubtful = rows.padded.doubtful;  // not needed any more
#pragma omp simd
  for (int k = 0; k < columns; ++k) doubtful[k] = static_cast<uint8_t>(d0[k] | d1[k] | d2[k] | d3[k] | d4[k]);
#pragma omp simd
  for (int k = 0; k < columns; ++k) {
    uint16_t nearest = n0[k] < n1[k] ? n0[k] : n1[k];
    nearest = n2[k] < nearest ? n2[k] : nearest;
    nearest = n3[k] < nearest ? n3[k] : nearest;
    nearest = n4[k] < nearest ? n4[k] : nearest;
    const auto half = static_cast<uint16_t>(nearest == kFar ? 0 : nearest >> 1);
    clear[k] = static_cast<uint16_t>(half | static_cast<uint16_t>((doubtful[k] ^ 1) << 15));
  }
#pragma omp simd
  for (int k = 0; k < columns; ++k) look[k] = static_cast<uint32_t>(mine[k]) | static_cast<uint32_t>(clear[k]) << 16;
}

// Nothing was measured in any row around.
POVSLAM_INLINE void say_nothing(int columns, LookPixel* look) {
  for (int k = 0; k < columns; ++k) look[k] = 0;
}

// Takes in row y of the part; after the last one of a line of tiles, writes these.
POVSLAM_INLINE void note_farthest(const LookSource& source, const Rows& rows, bool measured, int y,
                                  uint16_t* farthest) {
  const uint16_t* nearest = rows.padded.nearest + kClearRadius;
  uint16_t* most = rows.most;
  const int columns = source.columns, end_measured = measured ? columns : 0;
  if (y % kLookTile == 0) {
    for (int k = 0; k < columns; ++k) most[k] = 0;
  }
#pragma omp simd
  for (int k = 0; k < end_measured; ++k) {
    const auto depth = static_cast<uint16_t>(nearest[k] == kFar ? 0 : nearest[k]);
    most[k] = depth > most[k] ? depth : most[k];
  }
  if (y % kLookTile != kLookTile - 1 && y != source.rows - 1) return;
  uint16_t* tile = farthest + y / kLookTile * look_tiles(columns);
  for (int first = 0; first < columns; first += kLookTile) {
    const int end = first + kLookTile < columns ? first + kLookTile : columns;
    uint16_t largest = 0;
    for (int k = first; k < end; ++k) largest = most[k] > largest ? most[k] : largest;
    *tile++ = largest;
  }
}

}  // namespace

void make_look(const LookSource* source, LookPixel* look, uint16_t* farthest, uint16_t* scratch) {
  Rows rows = split_rows(scratch, source->columns + 2 * kClearRadius);
  int empty = 0;  // rows in succession
  for (int y = source->y0 - kClearRadius; y < source->y0 + source->rows + kClearRadius; ++y) {
    const int slot = (y + kWindow * kWindow) % kWindow, inside = y - source->y0;
    const RowWindow& reduced = rows.reduced[slot];
    const bool exists = y >= 0 && y < source->height;
    const bool measured = exists && read_row(*source, y, rows.padded, rows.mine[slot]);
    empty = measured ? 0 : empty + 1;
    if (!measured) fill_row(reduced, 0, source->columns);
    if (measured) reduce_nearest(source->columns, rows.padded.nearest, reduced.nearest);
    if (exists) reduce_doubtful(source->columns, rows.padded.doubtful, reduced.doubtful);
    if (exists && inside >= 0 && inside < source->rows) note_farthest(*source, rows, measured, inside, farthest);
    const int out = inside - kClearRadius;
    if (out < 0) continue;
    LookPixel* const to = look + static_cast<int64_t>(out) * source->columns;
    if (empty >= kWindow) {
      say_nothing(source->columns, to);
    } else {
      join_rows(source->columns, rows, rows.mine[(y - kClearRadius + kWindow * kWindow) % kWindow] + kClearRadius, to);
    }
  }
}

}  // namespace povslam::POVSLAM_ISA
