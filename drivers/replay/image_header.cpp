#include <algorithm>
#include <cctype>

#include "drivers/replay/image_codec.hpp"

namespace povslam {

namespace {

unsigned byte_at(std::span<const char> bytes, std::size_t i) {
  return static_cast<unsigned char>(bytes[i]);
}
unsigned big_endian_16(std::span<const char> bytes, std::size_t i) {
  return byte_at(bytes, i) << 8 | byte_at(bytes, i + 1);
}
unsigned big_endian_32(std::span<const char> bytes, std::size_t i) {
  return big_endian_16(bytes, i) << 16 | big_endian_16(bytes, i + 2);
}

// PNG (RFC 2083): signature, then the IHDR chunk.
Result<ImageHeader> png_header(std::span<const char> bytes) {
  constexpr std::size_t kHeaderBytes = 33;
  constexpr unsigned kMaxSide_px = 1U << 30;
  if (bytes.size() < kHeaderBytes) return Error{"the PNG ends inside its header"};
  const unsigned width = big_endian_32(bytes, 16), height = big_endian_32(bytes, 20);
  if (width == 0 || height == 0 || width > kMaxSide_px || height > kMaxSide_px) {
    return Error{"the PNG's header is damaged"};
  }
  const bool grey = (byte_at(bytes, 25) & 3U) == 0;  // bit 0: palette, bit 1: colour
  return ImageHeader{ImageFormat::png, static_cast<int>(width), static_cast<int>(height),
                     static_cast<int>(byte_at(bytes, 24)), grey};
}

// JPEG (ITU T.81): segments up to the start-of-frame marker, which holds the size.
Result<ImageHeader> jpeg_header(std::span<const char> bytes) {
  std::size_t i = 2;
  while (i + 4 <= bytes.size()) {
    const unsigned marker = byte_at(bytes, i + 1);
    if (byte_at(bytes, i) != 0xFF) break;
    if (marker == 0xFF) {  // fill byte
      ++i;
      continue;
    }
    const std::size_t length = big_endian_16(bytes, i + 2);
    const bool start_of_frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (start_of_frame && i + 10 <= bytes.size()) {
      const int height = static_cast<int>(big_endian_16(bytes, i + 5));
      const int width = static_cast<int>(big_endian_16(bytes, i + 7));
      if (width == 0 || height == 0) break;
      return ImageHeader{ImageFormat::jpeg, width, height, static_cast<int>(byte_at(bytes, i + 4)),
                         byte_at(bytes, i + 9) == 1};
    }
    if (length < 2) break;
    i += 2 + length;
  }
  return Error{"the JPEG ends inside its header or the header is damaged"};
}

// PGM (netpbm): "P5", width, height, maximum value, separated by blanks or comments; one blank, then the pixels.
Result<ImageHeader> pgm_header(std::span<const char> bytes) {
  constexpr int kMaxNumber = 1 << 24;
  int numbers[3] = {0, 0, 0};
  std::size_t i = 2;
  for (int& number : numbers) {
    while (i < bytes.size() && (std::isspace(static_cast<unsigned char>(bytes[i])) != 0 || bytes[i] == '#')) {
      if (bytes[i] == '#') {
        while (i < bytes.size() && bytes[i] != '\n') ++i;
      } else {
        ++i;
      }
    }
    while (i < bytes.size() && bytes[i] >= '0' && bytes[i] <= '9' && number < kMaxNumber) {
      number = number * 10 + (bytes[i++] - '0');
    }
  }
  const bool blank = i < bytes.size() && std::isspace(static_cast<unsigned char>(bytes[i])) != 0;
  const bool in_range = std::ranges::all_of(numbers, [](int n) { return n > 0 && n < kMaxNumber; });
  if (!blank || !in_range || numbers[2] > 65535) return Error{"the PGM's header is damaged"};
  return ImageHeader{ImageFormat::pgm, numbers[0], numbers[1], numbers[2] > 255 ? 16 : 8, true, i + 1};
}

}  // namespace

Result<ImageHeader> read_image_header(std::span<const char> bytes) {
  const std::string_view start(bytes.data(), std::min<std::size_t>(bytes.size(), 8));
  if (start.empty()) return Error{"the file is empty"};
  if (start == "\x89PNG\r\n\x1A\n") return png_header(bytes);
  if (start.starts_with("\xFF\xD8")) return jpeg_header(bytes);
  if (start.starts_with("P5")) return pgm_header(bytes);
  return Error{"neither PNG, JPEG nor binary PGM"};
}

}  // namespace povslam
