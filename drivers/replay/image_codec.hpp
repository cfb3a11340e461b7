// Decoders of one image format each: whole file in memory -> pixels. Pure; every read is bounded by `bytes`.
// Two steps, so that the caller decides on the size before memory is spent: header, then pixels.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "pipeline/base/result.hpp"

namespace povslam {

enum class ImageFormat { png, jpeg, pgm };

struct ImageHeader {
  ImageFormat format = ImageFormat::png;
  int width = 0, height = 0;    // px
  int bits = 8;                 // per channel, as stored
  bool grey = false;            // one channel and no palette
  std::size_t data_offset = 0;  // pgm: where the pixels begin
};

// Which of the formats it is and what its header says; an error when it is none of them or the header is cut.
Result<ImageHeader> read_image_header(std::span<const char> bytes);

// rows: height pointers to rows of the output. png: as 8 bits with 1 (grey) or 3 channels; with keep_16_bits as native
// 16-bit grey. jpeg: as 8 bits with 1 or 3 channels.
Status decode_png(std::span<const char> bytes, const ImageHeader& header, bool keep_16_bits, unsigned char** rows);
Status decode_jpeg(std::span<const char> bytes, const ImageHeader& header, unsigned char** rows);
Status decode_pgm(std::span<const char> bytes, const ImageHeader& header, unsigned char** rows);

}  // namespace povslam
