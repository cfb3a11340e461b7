#include "pipeline/backend/kernels/dispatch.hpp"

#include "pipeline/base/expects.hpp"

#define POVSLAM_DECLARE_KERNELS(isa)                                          \
  namespace isa {                                                             \
  double measure(const VemBlocks*, const VemPlaces*, const Quad*, Quad*);     \
  VemCost settle(const VemBlocks*, const VemPlaces*, Quad*, Quad*);           \
  void expect(const VemNoise*, const Quad*, VemExpect*, Quad*);               \
  VemDecision gate(const VemNoise*, double, const Quad*, const Quad*, Quad*); \
  void moments(const VemBlocks*, const VemPlaces*, VemMoments*);              \
  const VemKernels kVem{measure, settle, expect, gate, moments};              \
  }

namespace povslam {

POVSLAM_DECLARE_KERNELS(isa_v2)
POVSLAM_DECLARE_KERNELS(isa_v3)
POVSLAM_DECLARE_KERNELS(isa_v4)

const VemKernels& vem_kernels(int isa) {
  constexpr const VemKernels* kAll[kNumIsas] = {&isa_v2::kVem, &isa_v3::kVem, &isa_v4::kVem};
  EXPECTS(isa >= 0 && isa <= widest_isa());
  return *kAll[isa];
}

const VemKernels& vem_kernels() {
  static const VemKernels& chosen = vem_kernels(chosen_isa());
  return chosen;
}

}  // namespace povslam
