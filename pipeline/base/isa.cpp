#include "pipeline/base/isa.hpp"

#include <cstdlib>
#include <cstring>

namespace povslam {

namespace {

int choose() {
  constexpr const char* kNames[kNumIsas] = {"v2", "v3", "v4"};
  const char* wanted = std::getenv("POVSLAM_ISA");
  for (int isa = 0; wanted != nullptr && isa < widest_isa(); ++isa) {
    if (std::strcmp(wanted, kNames[isa]) == 0) return isa;
  }
  return widest_isa();
}

}  // namespace

int widest_isa() {
  __builtin_cpu_init();
  if (!__builtin_cpu_supports("x86-64-v3")) return 0;
  return __builtin_cpu_supports("x86-64-v4") ? 2 : 1;
}

int chosen_isa() {
  static const int chosen = choose();
  return chosen;
}

}  // namespace povslam
