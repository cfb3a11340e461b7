#include "pipeline/frontend/kernels/dispatch.hpp"

#include <cstdlib>
#include <cstring>

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
  __builtin_cpu_init();
  AvailableKernels available{{&isa_v2::kTable, nullptr, nullptr, nullptr}};
  if (!__builtin_cpu_supports("x86-64-v3")) return available;
  available.kernels[1] = &isa_v3::kTable;
  if (__builtin_cpu_supports("x86-64-v4")) available.kernels[2] = &isa_v4::kTable;
  return available;
}

namespace {

const FrontendKernels& choose() {
  const AvailableKernels available = available_kernels();
  const char* wanted = std::getenv("POVSLAM_ISA");
  const FrontendKernels* chosen = available.kernels[0];
  for (const FrontendKernels* const* k = available.kernels; *k != nullptr; ++k) {
    chosen = *k;
    if (wanted != nullptr && std::strcmp(wanted, chosen->isa) == 0) break;
  }
  return *chosen;
}

}  // namespace

const FrontendKernels& frontend_kernels() {
  static const FrontendKernels& chosen = choose();
  return chosen;
}

}  // namespace povslam
