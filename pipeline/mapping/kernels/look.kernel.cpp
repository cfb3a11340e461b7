// What one view says to one owner's volume, pixel by pixel.
#include "pipeline/mapping/kernels/kernels.hpp"
#include "pipeline/mapping/kernels/lanes.hpp"

namespace povslam::POVSLAM_ISA {
namespace {

enum { kWindow = 2 * kClearRadius + 1 };
constexpr float kFar = 1e9F;

// Least depth measured, and whether a surface is mine or nobody's (1, else 0), within kClearRadius along the row.
struct RowWindow {
  float* nearest;
  float* doubtful;
};

POVSLAM_INLINE void clear_row(const LookSource& source, RowWindow out) {
  for (int k = 0; k < source.columns; ++k) out.nearest[k] = kFar, out.doubtful[k] = 0.0F;
}

POVSLAM_INLINE void scan_row(const LookSource& source, int y, RowWindow padded, RowWindow out) {
  const int padded_columns = source.columns + 2 * kClearRadius;
  const int from = source.x0 - kClearRadius;
  const int begin = from < 0 ? -from : 0;
  const int end = from + padded_columns > source.width ? source.width - from : padded_columns;
  const float* depth = source.depth_m + static_cast<int64_t>(y) * source.stride + from;
  const uint16_t* owner = source.owner + static_cast<int64_t>(y) * source.stride + from;
  for (int k = 0; k < begin; ++k) padded.nearest[k] = kFar, padded.doubtful[k] = 0.0F;
  for (int k = end; k < padded_columns; ++k) padded.nearest[k] = kFar, padded.doubtful[k] = 0.0F;
  const int nobody = source.nobody, mine = source.mine;
#pragma omp simd
  for (int k = begin; k < end; ++k) {
    const float d = depth[k];
    const int whose = owner[k];
    padded.nearest[k] = d > 0.0F ? d : kFar;
    padded.doubtful[k] = ((whose == mine) | ((whose == nobody) & (d > 0.0F))) != 0 ? 1.0F : 0.0F;
  }
#pragma omp simd
  for (int k = 0; k < source.columns; ++k) {
    float nearest = padded.nearest[k], doubtful = padded.doubtful[k];
    for (int j = 1; j < kWindow; ++j) {
      nearest = padded.nearest[k + j] < nearest ? padded.nearest[k + j] : nearest;
      doubtful = padded.doubtful[k + j] > doubtful ? padded.doubtful[k + j] : doubtful;
    }
    out.nearest[k] = nearest;
    out.doubtful[k] = doubtful;
  }
}

POVSLAM_INLINE void join_rows(const LookSource& source, int y, const RowWindow* window, float* surface_m,
                              float* clear_m) {
  const float* depth = source.depth_m + static_cast<int64_t>(y) * source.stride + source.x0;
  const uint16_t* owner = source.owner + static_cast<int64_t>(y) * source.stride + source.x0;
  const int mine = source.mine;
#pragma omp simd
  for (int k = 0; k < source.columns; ++k) {
    float nearest = window[0].nearest[k], doubtful = window[0].doubtful[k];
    for (int j = 1; j < kWindow; ++j) {
      nearest = window[j].nearest[k] < nearest ? window[j].nearest[k] : nearest;
      doubtful = window[j].doubtful[k] > doubtful ? window[j].doubtful[k] : doubtful;
    }
    const float clear = nearest < kFar ? nearest : 0.0F;
    clear_m[k] = doubtful > 0.0F ? clear : -clear;
    surface_m[k] = owner[k] == mine ? depth[k] : 0.0F;
  }
}

}  // namespace

void make_look(const LookSource* source, float* surface_m, float* clear_m, float* scratch) {
  const int padded_columns = source->columns + 2 * kClearRadius;
  RowWindow rows[kWindow], padded{scratch + 2 * kWindow * padded_columns, scratch + (2 * kWindow + 1) * padded_columns};
  for (int j = 0; j < kWindow; ++j) {
    rows[j] = {scratch + 2 * j * padded_columns, scratch + (2 * j + 1) * padded_columns};
  }
  for (int y = source->y0 - kClearRadius; y < source->y0 + source->rows + kClearRadius; ++y) {
    const RowWindow row = rows[(y + kWindow * kWindow) % kWindow];
    if (y < 0 || y >= source->height) {
      clear_row(*source, row);
    } else {
      scan_row(*source, y, padded, row);
    }
    const int middle = y - kClearRadius, out = middle - source->y0;
    if (out < 0) continue;
    const int64_t begin = static_cast<int64_t>(out) * source->columns;
    join_rows(*source, middle, rows, surface_m + begin, clear_m + begin);
  }
}

}  // namespace povslam::POVSLAM_ISA
