// What one view says to one owner's volume, pixel by pixel.
#include "pipeline/mapping/kernels/kernels.hpp"
#include "pipeline/mapping/kernels/lanes.hpp"

namespace povslam::POVSLAM_ISA {
namespace {

enum { kWindow = 2 * kClearRadius + 1, kFar = 65535 };

struct RowWindow {
  uint16_t* nearest;   // depth [unit], kFar: none
  uint16_t* doubtful;  // 1: a surface is mine or nobody's
};
struct Row {
  RowWindow window;   // over the windows along the row
  uint16_t* surface;  // depth [unit] where it is mine, else 0
  bool measured;      // else nothing else is valid
};

POVSLAM_INLINE void fill_row(RowWindow row, int begin, int end) {
  for (int k = begin; k < end; ++k) row.nearest[k] = kFar, row.doubtful[k] = 0;
}

// Reads a row of the image, kClearRadius more on both sides; `surface` without those.
POVSLAM_INLINE void read_row(const LookSource& source, int y, RowWindow out, uint16_t* surface) {
  const int columns = source.columns + 2 * kClearRadius, from = source.x0 - kClearRadius;
  const int begin = from < 0 ? -from : 0;
  const int end = from + columns > source.width ? source.width - from : columns;
  const float* depth = source.depth_m + static_cast<int64_t>(y) * source.stride + from;
  const uint16_t* owner = source.owner + static_cast<int64_t>(y) * source.stride + from;
  fill_row(out, 0, begin);
  fill_row(out, end, columns);
  const float per_m = 1.0F / source.unit_m;
  const uint16_t nobody = source.nobody, mine = source.mine;
  uint16_t* nearest = out.nearest;
  uint16_t* doubtful = out.doubtful;
  uint16_t* seen = surface - kClearRadius;  // the margins lie in the scratch, too
#pragma omp simd
  for (int k = begin; k < end; ++k) {
    const auto units = static_cast<uint16_t>(static_cast<int32_t>(depth[k] * per_m + 0.5F));
    nearest[k] = units > 0 ? units : static_cast<uint16_t>(kFar);
    const auto is_mine = static_cast<uint16_t>(owner[k] == mine), is_nobody = static_cast<uint16_t>(owner[k] == nobody);
    doubtful[k] = static_cast<uint16_t>(is_mine | (is_nobody & static_cast<uint16_t>(units > 0)));
    seen[k] = is_mine != 0 ? units : static_cast<uint16_t>(0);
  }
}

// Over the windows along the row.
POVSLAM_INLINE void reduce_row(const LookSource& source, RowWindow padded, RowWindow out) {
  const uint16_t *nearest_in = padded.nearest, *doubtful_in = padded.doubtful;
  uint16_t *nearest_out = out.nearest, *doubtful_out = out.doubtful;
  const int columns = source.columns;
#pragma omp simd
  for (int k = 0; k < columns; ++k) {
    uint16_t nearest = nearest_in[k], doubtful = doubtful_in[k];
    for (int j = 1; j < kWindow; ++j) {
      nearest = nearest_in[k + j] < nearest ? nearest_in[k + j] : nearest;
      doubtful = static_cast<uint16_t>(doubtful | doubtful_in[k + j]);
    }
    nearest_out[k] = nearest;
    doubtful_out[k] = doubtful;
  }
}

POVSLAM_INLINE void join_rows(const LookSource& source, const Row* rows, const uint16_t* surface, LookPixel* look) {
  static_assert(kWindow == 5);
  const uint16_t *n0 = rows[0].window.nearest, *n1 = rows[1].window.nearest, *n2 = rows[2].window.nearest,
                 *n3 = rows[3].window.nearest, *n4 = rows[4].window.nearest;
  const uint16_t *d0 = rows[0].window.doubtful, *d1 = rows[1].window.doubtful, *d2 = rows[2].window.doubtful,
                 *d3 = rows[3].window.doubtful, *d4 = rows[4].window.doubtful;
  const int columns = source.columns;
#pragma omp simd
  for (int k = 0; k < columns; ++k) {
    uint16_t nearest = n0[k] < n1[k] ? n0[k] : n1[k];
    nearest = n2[k] < nearest ? n2[k] : nearest;
    nearest = n3[k] < nearest ? n3[k] : nearest;
    nearest = n4[k] < nearest ? n4[k] : nearest;
    const uint32_t doubtful = static_cast<uint32_t>(d0[k] | d1[k] | d2[k] | d3[k] | d4[k]);
    const uint32_t clear = nearest < kFar ? nearest / 2U : 0U;
    look[k] = surface[k] | clear << 16 | (doubtful ^ 1U) << 31;
  }
}

// Nothing was measured in any row around.
POVSLAM_INLINE void say_nothing(const LookSource& source, LookPixel* look) {
  for (int k = 0; k < source.columns; ++k) look[k] = 1U << 31;
}

}  // namespace

void make_look(const LookSource* source, LookPixel* look, uint16_t* scratch) {
  const int padded_columns = source->columns + 2 * kClearRadius;
  const auto strip = [&](int k) { return scratch + k * padded_columns; };
  const RowWindow padded{strip(0), strip(1)};
  Row rows[kWindow];
  for (int j = 0; j < kWindow; ++j) {
    rows[j] = {{strip(3 * j + 2), strip(3 * j + 3)}, strip(3 * j + 4) + kClearRadius, false};
    fill_row(rows[j].window, 0, source->columns);
    for (int k = 0; k < source->columns; ++k) rows[j].surface[k] = 0;
  }
  int empty = kWindow;  // rows in succession
  for (int y = source->y0 - kClearRadius; y < source->y0 + source->rows + kClearRadius; ++y) {
    Row& row = rows[(y + kWindow * kWindow) % kWindow];
    const bool measured = y >= 0 && y < source->height && source->measured[y] != 0;
    empty = measured ? 0 : empty + 1;
    if (measured) {
      read_row(*source, y, padded, row.surface);
      reduce_row(*source, padded, row.window);
    } else if (row.measured) {
      fill_row(row.window, 0, source->columns);
      for (int k = 0; k < source->columns; ++k) row.surface[k] = 0;
    }
    row.measured = measured;
    const int middle = y - kClearRadius, out = middle - source->y0;
    if (out < 0) continue;
    LookPixel* const to = look + static_cast<int64_t>(out) * source->columns;
    if (empty >= kWindow) {
      say_nothing(*source, to);
    } else {
      join_rows(*source, rows, rows[(middle + kWindow * kWindow) % kWindow].surface, to);
    }
  }
}

}  // namespace povslam::POVSLAM_ISA
