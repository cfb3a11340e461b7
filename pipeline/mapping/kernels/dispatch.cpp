#include "pipeline/mapping/kernels/dispatch.hpp"

#include "pipeline/base/expects.hpp"

#define POVSLAM_DECLARE_KERNELS(isa)                                                                \
  namespace isa {                                                                                   \
  void make_look(const LookSource*, LookPixel*, uint16_t*, uint16_t*);                              \
  unsigned integrate_block(const IntegratePass*, const BlockPlace*, int16_t*, uint16_t*, uint8_t*); \
  CompareSum compare_block(const ComparePass*, const float*, const int16_t*, const uint16_t*);      \
  int find_keys(const RayBlocks*, const float*, const float*, int, uint32_t*, uint32_t*);           \
  const MappingKernels kMapping{make_look, integrate_block, compare_block, find_keys};              \
  }

namespace povslam {

POVSLAM_DECLARE_KERNELS(isa_v2)
POVSLAM_DECLARE_KERNELS(isa_v3)
POVSLAM_DECLARE_KERNELS(isa_v4)

const MappingKernels& mapping_kernels(int isa) {
  constexpr const MappingKernels* kAll[kNumIsas] = {&isa_v2::kMapping, &isa_v3::kMapping, &isa_v4::kMapping};
  EXPECTS(isa >= 0 && isa <= widest_isa());
  return *kAll[isa];
}

const MappingKernels& mapping_kernels() {
  static const MappingKernels& chosen = mapping_kernels(chosen_isa());
  return chosen;
}

}  // namespace povslam
