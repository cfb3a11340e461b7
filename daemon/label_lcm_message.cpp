#include "daemon/label_lcm_message.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <povslam/label_image_t.hpp>
#include <vector>

#include "drivers/replay/image_codec.hpp"

namespace povslam {

namespace {

constexpr std::size_t kMaxText = 256;

// Reads LCM's encoding (big endian) front to back; after the first thing that does not fit everything is nothing.
class Cursor {
 public:
  explicit Cursor(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  std::int64_t integer(std::size_t size) {
    std::uint64_t value = 0;
    for (const std::uint8_t byte : take(size)) value = value << 8U | byte;
    return size == 4 ? static_cast<std::int32_t>(static_cast<std::uint32_t>(value)) : static_cast<std::int64_t>(value);
  }
  std::string text() {
    const std::int64_t length = integer(4);  // with the zero at its end
    if (length < 1 || length > static_cast<std::int64_t>(kMaxText)) good_ = false;
    const std::span<const std::uint8_t> content = take(good_ ? static_cast<std::size_t>(length) : 0);
    return content.empty() ? std::string() : std::string(content.begin(), content.end() - 1);
  }
  std::span<const std::uint8_t> bytes() {
    const std::int64_t count = integer(4);
    if (count < 0) good_ = false;
    return take(good_ ? static_cast<std::size_t>(count) : 0);
  }
  bool good() const { return good_; }
  bool at_end() const { return rest_.empty(); }

 private:
  std::span<const std::uint8_t> take(std::size_t count) {
    if (!good_ || count > rest_.size()) {
      good_ = false;
      return {};
    }
    const auto taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }

  std::span<const std::uint8_t> rest_;
  bool good_ = true;
};

template <class Pixel>
Status decode(std::span<const std::uint8_t> png, int width, int height, const char* what, Image<Pixel>& image) {
  constexpr int kBits = static_cast<int>(8 * sizeof(Pixel));
  const std::span<const char> bytes(reinterpret_cast<const char*>(png.data()), png.size());
  const Result<ImageHeader> header = read_image_header(bytes);
  if (!header) return Error{std::string(what) + ": " + header.error().message};
  const bool fits = header->format == ImageFormat::png && header->grey && header->bits == kBits &&
                    header->width == width && header->height == height;
  if (!fits) {
    return Error{std::string(what) + ": expected a grey PNG of " + std::to_string(kBits) + " bits and " +
                 std::to_string(width) + " x " + std::to_string(height) + " px"};
  }
  image.resize(width, height);
  std::vector<unsigned char*> rows(static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y) rows[static_cast<std::size_t>(y)] = reinterpret_cast<unsigned char*>(image.row(y));
  const Status decoded = decode_png(bytes, *header, kBits == 16, rows.data());
  return decoded ? decoded : Status(Error{std::string(what) + ": " + decoded.error().message});
}

}  // namespace

Result<LabelImage> read_label_image(std::span<const std::uint8_t> bytes, const LabelLimits& limits) {
  Cursor cursor(bytes);
  if (cursor.integer(8) != label_image_t::getHash()) {
    return Error{"another type than this daemon's povslam.label_image_t"};
  }
  LabelImage message;
  const std::int64_t utime = cursor.integer(8);
  cursor.integer(8);  // seq
  message.robot_id = cursor.text();
  message.labels.table_name = cursor.text();
  const std::int64_t width = cursor.integer(4), height = cursor.integer(4);
  const std::span<const std::uint8_t> classes = cursor.bytes(), instances = cursor.bytes();
  if (!cursor.good() || !cursor.at_end()) return Error{"the message's lengths contradict its size"};
  constexpr std::int64_t kMaxTime_us = std::numeric_limits<TimeNs>::max() / kNsPerUs;
  if (utime < -kMaxTime_us || utime > kMaxTime_us) return Error{"utime is no time"};
  if (width < 1 || height < 1 || width > limits.width || height > limits.height) {
    return Error{std::to_string(width) + " x " + std::to_string(height) + " px; the image has " +
                 std::to_string(limits.width) + " x " + std::to_string(limits.height)};
  }
  LabelFrame& labels = message.labels;
  labels.stamp = utime * kNsPerUs;
  const int w = static_cast<int>(width), h = static_cast<int>(height);
  if (const Status s = decode(classes, w, h, "classes_png", labels.classes); !s) return s.error();
  if (instances.empty()) return message;
  if (const Status s = decode(instances, w, h, "instances_png", labels.instances); !s) return s.error();
  return message;
}

}  // namespace povslam
