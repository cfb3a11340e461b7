// Recorded images: PNG (libpng), JPEG (libjpeg) and binary PGM, straight into a frame's buffer.
//
// The size is read from the header and compared before anything is allocated, so a file cannot ask for more memory than
// the calibration allows. Any damage is an error (a wrong checksum, a truncated or garbled stream, a JPEG that decodes
// only with warnings): a half-grey image is worse than a lost frame. Nothing is printed, nothing is thrown.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/base/result.hpp"
#include "pipeline/frames/image.hpp"

namespace povslam {

struct ImageSize {
  int width = 0, height = 0;  // px
};

// Keeps the file's bytes between images.
class ImageReader {
 public:
  // 8-bit grey (1 channel) or colour (3 channels R, G, B; palettes expanded, transparency dropped, 16 bits cut to 8).
  Status read_color(const std::filesystem::path& path, ImageSize size, ImageU8& image);
  // 16-bit grey PNG or PGM.
  Status read_u16(const std::filesystem::path& path, ImageSize size, ImageU16& image);
  // 8-bit grey PNG or PGM, values as stored.
  Status read_u8(const std::filesystem::path& path, ImageSize size, ImageU8& image);

 private:
  std::vector<char> bytes_;
  std::vector<unsigned char*> rows_;
};

}  // namespace povslam
