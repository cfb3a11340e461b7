#include "pipeline/frontend/vocabulary_data.hpp"

// The assembler puts the file into the program as it is: nothing to parse, at build time or at start.
__asm__(
    ".pushsection .rodata\n"
    ".balign 64\n"
    "povslam_vocabulary_begin:\n"
    ".incbin \"" POVSLAM_VOCABULARY_FILE
    "\"\n"
    "povslam_vocabulary_end:\n"
    ".byte 0\n"
    ".popsection\n");

extern "C" {
extern const std::byte povslam_vocabulary_begin[] __attribute__((visibility("hidden")));
extern const std::byte povslam_vocabulary_end[] __attribute__((visibility("hidden")));
}

namespace povslam {

std::span<const std::byte> vocabulary_data() {
  return {povslam_vocabulary_begin, povslam_vocabulary_end};
}

}  // namespace povslam
