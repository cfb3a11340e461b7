#include "pipeline/frontend/kernels/dispatch.hpp"

#include "pipeline/base/isa.hpp"

#define POVSLAM_DECLARE_KERNELS(isa)                                                               \
  namespace isa {                                                                                  \
  void shrink_row(const uint8_t*, const ShrinkTaps*, int, uint16_t*);                              \
  void blend_rows(const uint16_t*, const uint16_t*, int, int, uint8_t*);                           \
  void smooth_row(const uint8_t*, int64_t, int, uint8_t*, uint8_t*);                               \
  int find_corners(PixelView, PixelRect, int, uint8_t*, FastCorner*);                              \
  bool refine_corner(const uint8_t*, int64_t, CornerPeak*);                                        \
  PatchMoments patch_moments(const uint8_t*, int64_t, const PatchMask*);                           \
  void brief(const uint8_t*, const int32_t*, const int32_t*, uint64_t*);                           \
  void rgb_to_grey(const uint8_t*, uint8_t*, int64_t);                                             \
  const FrontendKernels kTable{#isa + 4,      shrink_row,    blend_rows, smooth_row, find_corners, \
                               refine_corner, patch_moments, brief,      rgb_to_grey};             \
  }

namespace povslam {

POVSLAM_DECLARE_KERNELS(isa_v2)
POVSLAM_DECLARE_KERNELS(isa_v3)
POVSLAM_DECLARE_KERNELS(isa_v4)

AvailableKernels available_kernels() {
  const FrontendKernels* all[kNumIsas] = {&isa_v2::kTable, &isa_v3::kTable, &isa_v4::kTable};
  AvailableKernels available{};
  for (int isa = 0; isa <= widest_isa(); ++isa) available.kernels[isa] = all[isa];
  return available;
}

const FrontendKernels& frontend_kernels() {
  static const FrontendKernels& chosen = *available_kernels().kernels[chosen_isa()];
  return chosen;
}

}  // namespace povslam
