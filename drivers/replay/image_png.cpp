// libpng's door. libpng reports errors by longjmp: between setjmp and the end only plain values live.
#include <png.h>

#include <csetjmp>
#include <cstdio>
#include <cstring>

#include "drivers/replay/image_codec.hpp"

namespace povslam {

namespace {

struct PngInput {
  const char* data;
  std::size_t left;
  char message[160];
};

void on_error(png_structp png, png_const_charp message) {
  auto* input = static_cast<PngInput*>(png_get_error_ptr(png));
  std::snprintf(input->message, sizeof input->message, "%s", message);
  std::longjmp(png_jmpbuf(png), 1);
}
void on_warning(png_structp, png_const_charp) {}

void on_read(png_structp png, png_bytep out, std::size_t count) {
  auto* input = static_cast<PngInput*>(png_get_io_ptr(png));
  if (count > input->left) png_error(png, "the file is truncated");
  std::memcpy(out, input->data, count);
  input->data += count;
  input->left -= count;
}

void ask_for_output(png_structp png, bool grey, bool keep_16_bits) {
  if (keep_16_bits) {
    png_set_swap(png);  // PNG is big endian, this machine is not
  } else {
    png_set_strip_16(png);
    png_set_expand_gray_1_2_4_to_8(png);
  }
  if (!grey) png_set_palette_to_rgb(png);
  png_set_strip_alpha(png);
  png_set_interlace_handling(png);
}

bool read_rows(png_structp png, png_infop info, PngInput* input, const ImageHeader* header, bool keep_16_bits,
               unsigned char** rows) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;  // NOLINT: libpng's way
  png_set_read_fn(png, input, on_read);
  png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_QUIET_USE);
  png_read_info(png, info);
  ask_for_output(png, header->grey, keep_16_bits);
  png_read_update_info(png, info);
  const std::size_t row_bytes =
      static_cast<std::size_t>(header->width) * (header->grey ? 1 : 3) * (keep_16_bits ? 2 : 1);
  const bool as_expected = png_get_rowbytes(png, info) == row_bytes &&
                           png_get_image_height(png, info) == static_cast<png_uint_32>(header->height);
  if (!as_expected) png_error(png, "the header contradicts itself");
  png_read_image(png, rows);
  png_read_end(png, nullptr);
  return true;
}

}  // namespace

Status decode_png(std::span<const char> bytes, const ImageHeader& header, bool keep_16_bits, unsigned char** rows) {
  PngInput input{bytes.data(), bytes.size(), {}};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &input, on_error, on_warning);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  const bool whole = info != nullptr && read_rows(png, info, &input, &header, keep_16_bits, rows);
  png_destroy_read_struct(&png, &info, nullptr);
  if (!whole) return Error{std::string("broken PNG: ") + input.message};
  return Done{};
}

}  // namespace povslam
