// The blocks that rays pass at a distance beyond their surfaces.
#include "pipeline/mapping/kernels/kernels.hpp"
#include "pipeline/mapping/kernels/lanes.hpp"

namespace povslam::POVSLAM_ISA {
namespace {
constexpr unsigned kAllLanes = static_cast<unsigned>((uint64_t{1} << kLanes) - 1);
}

int find_keys(const RayBlocks* rays, const float* depth_m, const float* column, int count, uint32_t* keys,
              uint32_t* scratch) {
  const float sx = rays->start[0], sy = rays->start[1], sz = rays->start[2], fx = rays->first[0], fy = rays->first[1],
              fz = rays->first[2], ax = rays->along[0], ay = rays->along[1], az = rays->along[2],
              ahead_m = rays->ahead_m;
#pragma omp simd
  for (int k = 0; k < count; ++k) {
    const float far = depth_m[k] + ahead_m, at = far > 0.0F ? far : 0.0F;
    const auto x = static_cast<int32_t>(sx + (fx + ax * column[k]) * at),
               y = static_cast<int32_t>(sy + (fy + ay * column[k]) * at),
               z = static_cast<int32_t>(sz + (fz + az * column[k]) * at);
    scratch[k + 1] = static_cast<uint32_t>(x | y << kKeyBits | z << 2 * kKeyBits);
  }
  // Beside it no key: bits beyond 3 kKeyBits are never set.
  scratch[0] = ~0U;
  for (int k = count; k < count + kLanes; ++k) scratch[k + 1] = scratch[count];
  int different = 0;
  for (int k = 0; k < count; k += kLanes) {
    unsigned left = kAllLanes & ~bits(equal(load(scratch + k), load(scratch + k + 1)));
    for (; left != 0; left &= left - 1) keys[different++] = scratch[k + __builtin_ctz(left) + 1];
  }
  return different;
}

}  // namespace povslam::POVSLAM_ISA
