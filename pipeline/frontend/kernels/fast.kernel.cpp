// FAST-9 (Rosten and Drummond, ECCV 2006) with the exact score: a pixel is a corner at threshold t if nine
// neighbours in a row on the circle of 16 are all brighter than it by more than t, or all darker. So the score is
// max over arcs of (min over the arc) - centre - 1, and likewise for dark.
#include "pipeline/frontend/kernels/kernels.hpp"
#include "pipeline/frontend/kernels/simd.hpp"

namespace povslam::POVSLAM_ISA {
namespace {

struct Circle {
  Bytes p[16];
};

POVSLAM_INLINE Circle load_circle(const uint8_t* centre, int64_t stride) {
  const uint8_t *up3 = centre - 3 * stride, *up2 = centre - 2 * stride, *up1 = centre - stride;
  const uint8_t *down1 = centre + stride, *down2 = centre + 2 * stride, *down3 = centre + 3 * stride;
  return {{load(up3), load(up3 + 1), load(up2 + 2), load(up1 + 3), load(centre + 3), load(down1 + 3), load(down2 + 2),
           load(down3 + 1), load(down3), load(down3 - 1), load(down2 - 2), load(down1 - 3), load(centre - 3),
           load(up1 - 3), load(up2 - 2), load(up3 - 1)}};
}

// max over the 16 arcs of nine of (min over the arc). Two arcs that share eight pixels differ in one end each:
// max(min(shared, a), min(shared, b)) = min(shared, max(a, b)).
POVSLAM_INLINE Bytes brightest_arc(const Circle& c) {
  Bytes pairs[8], quads[8], best = zero();
  for (int k = 0; k < 8; ++k) pairs[k] = min(c.p[2 * k + 1], c.p[(2 * k + 2) & 15]);
  for (int k = 0; k < 8; ++k) quads[k] = min(pairs[k], pairs[(k + 1) & 7]);
  for (int k = 0; k < 8; ++k) {
    const Bytes shared = min(quads[k], quads[(k + 2) & 7]);
    best = max(best, min(shared, max(c.p[2 * k], c.p[(2 * k + 9) & 15])));
  }
  return best;
}

POVSLAM_INLINE Bytes darkest_arc(const Circle& c) {
  Bytes pairs[8], quads[8], best = fill8(255);
  for (int k = 0; k < 8; ++k) pairs[k] = max(c.p[2 * k + 1], c.p[(2 * k + 2) & 15]);
  for (int k = 0; k < 8; ++k) quads[k] = max(pairs[k], pairs[(k + 1) & 7]);
  for (int k = 0; k < 8; ++k) {
    const Bytes shared = max(quads[k], quads[(k + 2) & 7]);
    best = min(best, max(shared, min(c.p[2 * k], c.p[(2 * k + 9) & 15])));
  }
  return best;
}

// An arc of nine holds two neighbouring compass points: without such a pair there is no corner.
POVSLAM_INLINE bool may_hold_corner(const uint8_t* centre, int64_t stride, Bytes threshold) {
  const Bytes north = load(centre - 3 * stride), south = load(centre + 3 * stride);
  const Bytes west = load(centre - 3), east = load(centre + 3), middle = load(centre);
  const Bytes bright = min(max(north, south), max(west, east));
  const Bytes dark = max(min(north, south), min(west, east));
  return greater(max(subs(bright, middle), subs(middle, dark)), threshold) != 0;
}

// scores[x - x0] = score + 1 of pixels x0 <= x < x1 where score >= threshold, else 0.
POVSLAM_INLINE void score_row(const uint8_t* row, int64_t stride, int x0, int x1, int threshold, uint8_t* scores) {
  const Bytes limit = fill8(threshold);
  for (int x = x0; x < x1; x += kLanes) {
    Bytes score = zero();
    if (may_hold_corner(row + x, stride, limit)) {
      const Circle circle = load_circle(row + x, stride);
      const Bytes middle = load(row + x);
      score = max(subs(brightest_arc(circle), middle), subs(middle, darkest_arc(circle)));
      score = keep_greater(score, limit);
    }
    store(scores + (x - x0), score);
  }
  store(scores + (x1 - x0), zero());  // the last vector may have scored pixels past the row
}

POVSLAM_INLINE FastCorner* local_maxima(const uint8_t* above, const uint8_t* here, const uint8_t* below, int width,
                                        int x0, int y, FastCorner* out) {
  for (int x = 0; x < width; x += kLanes) {
    const Bytes score = load(here + x);
    const Bytes before = max(max(load(above + x - 1), load(above + x)), max(load(above + x + 1), load(here + x - 1)));
    const Bytes after = max(max(load(below + x - 1), load(below + x)), max(load(below + x + 1), load(here + x + 1)));
    uint64_t peaks = greater(score, before) & ~greater(after, score);
    for (; peaks != 0; peaks &= peaks - 1) {
      const int at = x + __builtin_ctzll(peaks);
      out->x = static_cast<uint16_t>(x0 + at);
      out->y = static_cast<uint16_t>(y);
      out->score = static_cast<uint8_t>(here[at] - 1);
      out->dx = out->dy = 0.0F;
      ++out;
    }
  }
  return out;
}

}  // namespace

int find_corners(PixelView image, PixelRect rect, int threshold, uint8_t* scratch, FastCorner* corners) {
  const int width = rect.x1 - rect.x0;
  const int64_t pitch = width + 2 * kKernelSlack;
  uint8_t* rows[3];
  for (int k = 0; k < 3; ++k) rows[k] = scratch + k * pitch + kKernelSlack;
  for (int64_t k = 0; k < 3 * pitch; ++k) scratch[k] = 0;
  FastCorner* out = corners;
  score_row(image.pixels + rect.y0 * image.stride, image.stride, rect.x0, rect.x1, threshold, rows[1]);
  for (int y = rect.y0; y < rect.y1; ++y) {
    if (y + 1 < rect.y1) {
      score_row(image.pixels + (y + 1) * image.stride, image.stride, rect.x0, rect.x1, threshold, rows[2]);
    } else {
      for (int k = 0; k < width; ++k) rows[2][k] = 0;
    }
    out = local_maxima(rows[0], rows[1], rows[2], width, rect.x0, y, out);
    uint8_t* const oldest = rows[0];
    rows[0] = rows[1];
    rows[1] = rows[2];
    rows[2] = oldest;
  }
  return static_cast<int>(out - corners);
}

}  // namespace povslam::POVSLAM_ISA
