#include "drivers/replay/pcd_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>

namespace povslam {

namespace {

constexpr std::size_t kMaxFields = 32;
constexpr std::size_t kMaxPointBytes = 4096;

struct Field {
  std::string_view name;
  std::size_t offset = 0;
  std::size_t size = 0;
  std::size_t count = 1;
  char type = 'F';  // F, I or U
};

struct Header {
  std::array<Field, kMaxFields> fields;
  std::size_t num_fields = 0;
  std::size_t num_points = 0;
  std::size_t point_bytes = 0;
  std::size_t data_offset = 0;
};

std::string_view next_word(std::string_view& line) {
  const std::size_t begin = std::min(line.find_first_not_of(" \t\r"), line.size());
  const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

bool read_count(std::string_view word, std::size_t& value) {
  const auto [end, fault] = std::from_chars(word.begin(), word.end(), value);
  return !word.empty() && fault == std::errc{} && end == word.end();
}

// Interprets one header line; false when its values make no sense.
bool read_header_line(std::string_view key, std::string_view rest, Header& header) {
  if (key == "POINTS") return read_count(next_word(rest), header.num_points);
  std::size_t i = 0;
  for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest), ++i) {
    if (i >= kMaxFields) return false;
    Field& field = header.fields[i];
    if (key == "FIELDS") field.name = word;
    if (key == "TYPE") field.type = word[0];
    if (key == "SIZE" && !read_count(word, field.size)) return false;
    if (key == "COUNT" && !read_count(word, field.count)) return false;
  }
  if (key == "FIELDS") header.num_fields = i;
  return true;
}

bool lay_out(Header& header) {
  for (std::size_t i = 0; i < header.num_fields; ++i) {
    Field& field = header.fields[i];
    const bool known_size = field.size == 1 || field.size == 2 || field.size == 4 || field.size == 8;
    if (!known_size || field.count == 0 || field.count > kMaxPointBytes) return false;
    field.offset = header.point_bytes;
    header.point_bytes += field.size * field.count;
  }
  return header.point_bytes > 0 && header.point_bytes <= kMaxPointBytes;
}

Result<Header> read_header(std::string_view text) {
  Header header;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t end = rest.find('\n');
    if (end == std::string_view::npos) break;
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end + 1);
    const std::string_view key = next_word(line);
    if (key == "DATA") {
      if (next_word(line) != "binary") return Error{"only PCD with DATA binary is read"};
      header.data_offset = text.size() - rest.size();
      if (!lay_out(header)) break;
      return header;
    }
    if (key.starts_with('#')) continue;
    if (!read_header_line(key, line, header)) break;
  }
  return Error{"the PCD's header is damaged"};
}

template <class T>
T load(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

double value_of(const Field& field, const char* point) {
  const char* at = point + field.offset;
  const bool is_signed = field.type == 'I';
  if (field.type == 'F') return field.size == 8 ? load<double>(at) : field.size == 4 ? double{load<float>(at)} : 0.0;
  switch (field.size) {
    case 1:
      return is_signed ? load<std::int8_t>(at) : load<std::uint8_t>(at);
    case 2:
      return is_signed ? load<std::int16_t>(at) : load<std::uint16_t>(at);
    case 4:
      return is_signed ? load<std::int32_t>(at) : load<std::uint32_t>(at);
    default:
      return static_cast<double>(is_signed ? load<std::int64_t>(at)
                                           : static_cast<std::int64_t>(load<std::uint64_t>(at)));
  }
}

const Field* find(const Header& header, std::string_view name) {
  for (std::size_t i = 0; i < header.num_fields; ++i) {
    if (header.fields[i].name == name) return &header.fields[i];
  }
  return nullptr;
}

}  // namespace

Status decode_pcd(std::span<const char> bytes, std::vector<LidarPoint>& points) {
  points.clear();
  const Result<Header> header = read_header({bytes.data(), bytes.size()});
  if (!header) return header.error();
  const Field *x = find(*header, "x"), *y = find(*header, "y"), *z = find(*header, "z");
  const Field *intensity = find(*header, "intensity"), *t = find(*header, "t"), *ring = find(*header, "ring");
  if (x == nullptr || y == nullptr || z == nullptr) return Error{"the PCD has no fields x y z"};
  if (header->num_points > (bytes.size() - header->data_offset) / header->point_bytes)
    return Error{"the PCD is truncated"};
  const double seconds_per_t = t != nullptr && t->type == 'F' ? 1.0 : 1e-9;
  for (std::size_t i = 0; i < header->num_points; ++i) {
    const char* at = bytes.data() + header->data_offset + i * header->point_bytes;
    LidarPoint point;
    point.x = static_cast<float>(value_of(*x, at));
    point.y = static_cast<float>(value_of(*y, at));
    point.z = static_cast<float>(value_of(*z, at));
    const bool finite = std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
    if (!finite || (point.x == 0.0F && point.y == 0.0F && point.z == 0.0F)) continue;
    if (intensity != nullptr) point.intensity = static_cast<float>(value_of(*intensity, at));
    if (t != nullptr) point.t_offset_s = static_cast<float>(value_of(*t, at) * seconds_per_t);
    if (ring != nullptr && ring->type != 'F')
      point.ring = static_cast<std::uint16_t>(std::clamp(value_of(*ring, at), 0.0, 65535.0));
    points.push_back(point);
  }
  return Done{};
}

}  // namespace povslam
