// libjpeg's door. libjpeg reports errors by longjmp: between setjmp and the end only plain values live.
#include <cstdio>  // jpeglib.h needs it first

#include <jpeglib.h>

#include <csetjmp>

#include "drivers/replay/image_codec.hpp"

namespace povslam {

namespace {

constexpr int kMaxScans = 200;  // a progressive file of millions of tiny scans would decode for hours

struct JpegErrors {
  jpeg_error_mgr manager;
  std::jmp_buf escape;
  char message[JMSG_LENGTH_MAX];
  jpeg_progress_mgr progress;
};

[[noreturn]] void on_error(j_common_ptr jpeg) {
  auto* errors = reinterpret_cast<JpegErrors*>(jpeg->err);
  (*jpeg->err->format_message)(jpeg, errors->message);
  std::longjmp(errors->escape, 1);
}

void on_message(j_common_ptr jpeg, int level) {
  if (level < 0) on_error(jpeg);  // a warning is damaged data
}

void on_progress(j_common_ptr jpeg) {
  const auto* decompress = reinterpret_cast<j_decompress_ptr>(jpeg);
  if (decompress->input_scan_number <= kMaxScans) return;
  auto* errors = reinterpret_cast<JpegErrors*>(jpeg->err);
  std::snprintf(errors->message, sizeof errors->message, "more than %d scans", kMaxScans);
  std::longjmp(errors->escape, 1);
}

bool read_rows(jpeg_decompress_struct* jpeg, JpegErrors* errors, std::span<const char> bytes, const ImageHeader& header,
               unsigned char** rows) {
  if (setjmp(errors->escape) != 0) return false;  // NOLINT: libjpeg's way
  jpeg_create_decompress(jpeg);
  errors->progress.progress_monitor = on_progress;
  jpeg->progress = &errors->progress;
  jpeg_mem_src(jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(jpeg, TRUE);
  if (jpeg->image_width != static_cast<unsigned>(header.width) ||
      jpeg->image_height != static_cast<unsigned>(header.height)) {
    std::snprintf(errors->message, sizeof errors->message, "two sizes in one file");
    return false;
  }
  jpeg->out_color_space = header.grey ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_start_decompress(jpeg);
  while (jpeg->output_scanline < jpeg->output_height) {
    jpeg_read_scanlines(jpeg, rows + jpeg->output_scanline, jpeg->output_height - jpeg->output_scanline);
  }
  jpeg_finish_decompress(jpeg);
  return true;
}

}  // namespace

Status decode_jpeg(std::span<const char> bytes, const ImageHeader& header, unsigned char** rows) {
  JpegErrors errors{};
  jpeg_decompress_struct jpeg{};
  jpeg.err = jpeg_std_error(&errors.manager);
  errors.manager.error_exit = on_error;
  errors.manager.emit_message = on_message;
  const bool whole = read_rows(&jpeg, &errors, bytes, header, rows);
  jpeg_destroy_decompress(&jpeg);
  if (!whole) return Error{std::string("broken JPEG: ") + errors.message};
  return Done{};
}

}  // namespace povslam
