#include "daemon/label_protocol.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace povslam {

namespace {

static_assert(std::endian::native == std::endian::little);  // as on the wire

constexpr std::uint32_t kMagic = 0x424C5650;  // "PVLB"
constexpr std::uint32_t kWithDepth = 1;
constexpr std::size_t kMaxTableName = 64;

template <class Number>
Number number_at(std::span<const std::uint8_t> bytes, std::size_t offset) {
  EXPECTS(offset + sizeof(Number) <= bytes.size());
  Number number{};
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

template <class Number>
void append(Number number, std::vector<std::uint8_t>& out) {
  out.resize(out.size() + sizeof number);
  std::memcpy(out.data() + out.size() - sizeof number, &number, sizeof number);
}
template <class Pixel>
void append(const Image<Pixel>& image, std::vector<std::uint8_t>& out) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(image.data());
  out.insert(out.end(), bytes, bytes + image.size() * sizeof(Pixel));
}
void append_header(LabelMessage type, std::size_t length, std::vector<std::uint8_t>& out) {
  append(kMagic, out);
  append(kLabelProtocolVersion, out);
  append(static_cast<std::uint16_t>(type), out);
  append(static_cast<std::uint32_t>(length), out);
}

std::size_t max_length(LabelMessage type, const LabelLimits& limits) {
  if (type == LabelMessage::hello) return sizeof(std::uint32_t) + kMaxTableName;
  if (type == LabelMessage::next) return 0;
  return kLabelHeadBytes + std::size_t{3} * limits.width * limits.height;
}

}  // namespace

Result<LabelHeader> read_label_header(std::span<const std::uint8_t> bytes, const LabelLimits& limits) {
  EXPECTS(bytes.size() == kLabelHeaderBytes);
  if (number_at<std::uint32_t>(bytes, 0) != kMagic) return Error{"a message does not begin with PVLB"};
  const auto version = number_at<std::uint16_t>(bytes, 4);
  if (version != kLabelProtocolVersion) {
    return Error{"protocol version " + std::to_string(version) + "; this daemon speaks " +
                 std::to_string(kLabelProtocolVersion)};
  }
  const auto type = static_cast<LabelMessage>(number_at<std::uint16_t>(bytes, 6));
  if (type != LabelMessage::hello && type != LabelMessage::next && type != LabelMessage::labels) {
    return Error{"message type " + std::to_string(static_cast<int>(type)) +
                 "; a source sends 1 hello, 4 next, 6 labels"};
  }
  const auto length = number_at<std::uint32_t>(bytes, 8);
  if (length > max_length(type, limits)) {
    return Error{"a message of type " + std::to_string(static_cast<int>(type)) + " with " + std::to_string(length) +
                 " bytes; at most " + std::to_string(max_length(type, limits)) + " are allowed"};
  }
  return LabelHeader{type, length};
}

Result<LabelHello> read_label_hello(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kFlags = sizeof(std::uint32_t);
  if (bytes.size() <= kFlags) return Error{"hello: expected flags and the name of a class table"};
  const auto flags = number_at<std::uint32_t>(bytes, 0);
  if ((flags & ~kWithDepth) != 0) return Error{"hello: unknown flags; only bit 0 (with depth) is known"};
  LabelHello hello{flags == kWithDepth, std::string(bytes.begin() + kFlags, bytes.end())};
  const bool printable =
      std::all_of(hello.table.begin(), hello.table.end(), [](char c) { return c >= ' ' && c <= '~'; });
  if (!printable) return Error{"hello: the name of the class table is no plain text"};
  return hello;
}

Result<LabelFrame> read_labels(std::span<const std::uint8_t> bytes, const LabelLimits& limits) {
  if (bytes.size() < kLabelHeadBytes) return Error{"labels: the message ends inside its head"};
  const auto width = number_at<std::uint32_t>(bytes, 8), height = number_at<std::uint32_t>(bytes, 12);
  const std::uint8_t format = bytes[16];
  if (format != 1 && format != 2) return Error{"labels: format must be 1 (classes) or 2 (classes and instances)"};
  const bool in_range = width > 0 && height > 0 && width <= static_cast<std::uint32_t>(limits.width) &&
                        height <= static_cast<std::uint32_t>(limits.height);
  if (!in_range) {
    return Error{"labels: " + std::to_string(width) + " x " + std::to_string(height) + " px; the image has " +
                 std::to_string(limits.width) + " x " + std::to_string(limits.height)};
  }
  const std::size_t pixels = std::size_t{width} * height;
  const std::size_t expected = kLabelHeadBytes + pixels * (format == 2 ? 3 : 1);
  if (bytes.size() != expected) {
    return Error{"labels: " + std::to_string(bytes.size()) + " bytes; size and format make " +
                 std::to_string(expected)};
  }
  LabelFrame labels;
  labels.stamp = number_at<std::int64_t>(bytes, 0);
  labels.classes.resize(static_cast<int>(width), static_cast<int>(height));
  std::memcpy(labels.classes.data(), bytes.data() + kLabelHeadBytes, pixels);
  if (format == 2) {
    labels.instances.resize(static_cast<int>(width), static_cast<int>(height));
    std::memcpy(labels.instances.data(), bytes.data() + kLabelHeadBytes + pixels, 2 * pixels);
  }
  return labels;
}

void write_welcome(const LabelLimits& limits, std::vector<std::uint8_t>& out) {
  append_header(LabelMessage::welcome, 2 * sizeof(std::uint32_t), out);
  append(static_cast<std::uint32_t>(limits.width), out);
  append(static_cast<std::uint32_t>(limits.height), out);
}

void write_refused(const std::string& reason, std::vector<std::uint8_t>& out) {
  append_header(LabelMessage::refused, reason.size(), out);
  out.insert(out.end(), reason.begin(), reason.end());
}

void write_image(const RgbdFrame& image, bool with_depth, std::vector<std::uint8_t>& out) {
  const ImageU8& color = image.color;
  const bool depth = with_depth && image.depth.width() == color.width() && image.depth.height() == color.height();
  const std::size_t pixels = color.size() + (depth ? image.depth.size() * sizeof(std::uint16_t) : 0);
  append_header(LabelMessage::image, kLabelHeadBytes + pixels, out);
  append(image.stamp, out);
  append(static_cast<std::uint32_t>(color.width()), out);
  append(static_cast<std::uint32_t>(color.height()), out);
  append(static_cast<std::uint8_t>(color.channels() == 3 ? 1 : 2), out);
  append(static_cast<std::uint8_t>(depth ? 1 : 0), out);
  append(std::uint16_t{0}, out);
  append(image.depth_scale, out);
  append(color, out);
  if (depth) append(image.depth, out);
}

}  // namespace povslam
