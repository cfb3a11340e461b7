// Where one thing ends and another begins: in the valley of a concave fold, and behind a jump (after Tateno et al.,
// IROS 2015, in inverse depth). On a plane the cells to both sides average to the middle one; in a valley and just
// behind a nearer surface the average is nearer than the middle. Convex edges of a thing, and the near side of a jump,
// show the opposite sign and stay whole.
#include <algorithm>
#include <cmath>

#include "pipeline/objects/segment_grid.hpp"

namespace povslam {

namespace {

constexpr int kReach = 4;  // cells to each side

// How much nearer the chord over the cell is than the cell.
inline float valley(const float* w, int stride) {
  const float before = w[-stride], after = w[stride];
  const float both = 0.5F * (before + after) - w[0];
  return before > 0.0F && after > 0.0F ? both : 0.0F;
}

}  // namespace

void find_edges(const SegmentOptions& options, SegmentGrid& grid) {
  // Of half a sum of two and one: sqrt(1.5) sigma.
  const float noise = 1.225F * static_cast<float>(options.jump_sigmas) * smooth_sigma(options, grid);
  const auto cosine = static_cast<float>(options.normal_cosine);
  // A symmetric fold by an angle a lies kReach / focal * tan(a / 2) of its depth behind its chord.
  const float fold = kReach / grid.focal_x * std::sqrt((1.0F - cosine) / (1.0F + cosine));
  const float share = std::max(fold, 0.5F * static_cast<float>(options.jump_share));
  for (int row = 0; row < grid.height; ++row) {
    const float* w = grid.w.data() + grid.index(0, row);
    std::uint8_t* edge = grid.edge.data() + grid.index(0, row);
    for (int x = 0; x < grid.width; ++x) {
      const float far = std::max(valley(w + x, kReach), valley(w + x, kReach * grid.stride));
      const float near = std::max(valley(w + x, kReach / 2), valley(w + x, kReach / 2 * grid.stride));
      edge[x] = std::max(far, near) > noise + share * w[x] && w[x] > 0.0F;
    }
  }
}

}  // namespace povslam
