// The vocabulary that is built into the program: the bytes of vocabulary.bin.
#pragma once

#include <cstddef>
#include <span>

namespace povslam {

std::span<const std::byte> vocabulary_data();

}  // namespace povslam
