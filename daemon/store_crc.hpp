// CRC-32C (Castagnoli; RFC 3720, appendix B.4): the checksum on each row of the map on disk. Finds every burst of up to
// 32 flipped bits, and all but one in 4e9 of other damage.
#pragma once

#include <cstdint>
#include <span>

namespace povslam {

// Of the bytes alone with `before` = 0; of a longer text when given the value of what stood before.
std::uint32_t crc32c(std::span<const std::uint8_t> bytes, std::uint32_t before = 0);

}  // namespace povslam
