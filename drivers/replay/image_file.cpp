#include "drivers/replay/image_file.hpp"

#include <cstring>

#include "drivers/replay/image_codec.hpp"
#include "drivers/replay/text_file.hpp"

namespace povslam {

namespace {

constexpr std::size_t kMaxImageBytes = std::size_t{64} << 20;

std::string wrong_size(const ImageHeader& header, ImageSize size) {
  return std::to_string(header.width) + " x " + std::to_string(header.height) + " px, the calibration says " +
         std::to_string(size.width) + " x " + std::to_string(size.height);
}

Result<ImageHeader> read_header(const std::filesystem::path& path, ImageSize size, std::vector<char>& bytes) {
  if (const Status status = read_bytes(path, kMaxImageBytes, bytes); !status) return status.error();
  const Result<ImageHeader> header = read_image_header(bytes);
  if (!header) return Error{path.string() + ": " + header.error().message};
  if (header->width != size.width || header->height != size.height) {
    return Error{path.string() + ": " + wrong_size(*header, size)};
  }
  return header;
}

template <class Pixel>
unsigned char** point_to_rows(Image<Pixel>& image, std::vector<unsigned char*>& rows) {
  rows.resize(static_cast<std::size_t>(image.height()));
  for (int y = 0; y < image.height(); ++y)
    rows[static_cast<std::size_t>(y)] = reinterpret_cast<unsigned char*>(image.row(y));
  return rows.data();
}

Status decode(std::span<const char> bytes, const ImageHeader& header, bool keep_16_bits, unsigned char** rows) {
  switch (header.format) {
    case ImageFormat::png:
      return decode_png(bytes, header, keep_16_bits, rows);
    case ImageFormat::jpeg:
      return decode_jpeg(bytes, header, rows);
    case ImageFormat::pgm:
      return decode_pgm(bytes, header, rows);
  }
  return Error{"unknown format"};
}

Status named(const std::filesystem::path& path, Status status) {
  if (status) return status;
  return Error{path.string() + ": " + status.error().message};
}

}  // namespace

Status decode_pgm(std::span<const char> bytes, const ImageHeader& header, unsigned char** rows) {
  const std::size_t row_bytes = static_cast<std::size_t>(header.width) * (header.bits / 8);
  if (bytes.size() - header.data_offset < row_bytes * header.height) return Error{"broken PGM: the file is truncated"};
  const char* in = bytes.data() + header.data_offset;
  for (int y = 0; y < header.height; ++y, in += row_bytes) {
    std::memcpy(rows[y], in, row_bytes);
    if (header.bits == 8) continue;
    for (std::size_t i = 0; i < row_bytes; i += 2) std::swap(rows[y][i], rows[y][i + 1]);  // big endian in the file
  }
  return Done{};
}

Status ImageReader::read_color(const std::filesystem::path& path, ImageSize size, ImageU8& image) {
  const Result<ImageHeader> header = read_header(path, size, bytes_);
  if (!header) return header.error();
  if (header->format == ImageFormat::pgm && header->bits != 8) {
    return Error{path.string() + ": " + std::to_string(header->bits) + " bits, colour has 8"};
  }
  image.resize(size.width, size.height, header->grey ? 1 : 3);
  return named(path, decode(bytes_, *header, false, point_to_rows(image, rows_)));
}

Status ImageReader::read_u16(const std::filesystem::path& path, ImageSize size, ImageU16& image) {
  const Result<ImageHeader> header = read_header(path, size, bytes_);
  if (!header) return header.error();
  if (header->format == ImageFormat::jpeg || !header->grey || header->bits != 16) {
    return Error{path.string() + ": " + std::to_string(header->bits) + "-bit " + (header->grey ? "grey" : "colour") +
                 ", 16-bit grey PNG or PGM is expected"};
  }
  image.resize(size.width, size.height);
  return named(path, decode(bytes_, *header, true, point_to_rows(image, rows_)));
}

Status ImageReader::read_u8(const std::filesystem::path& path, ImageSize size, ImageU8& image) {
  const Result<ImageHeader> header = read_header(path, size, bytes_);
  if (!header) return header.error();
  if (header->format == ImageFormat::jpeg || !header->grey || header->bits != 8) {
    return Error{path.string() + ": " + std::to_string(header->bits) + "-bit " + (header->grey ? "grey" : "colour") +
                 ", 8-bit grey PNG or PGM is expected"};
  }
  image.resize(size.width, size.height);
  return named(path, decode(bytes_, *header, false, point_to_rows(image, rows_)));
}

}  // namespace povslam
